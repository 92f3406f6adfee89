/* The options that several commands share. */
#include <string.h>

#include "client/cli/options/lights_text.h"
#include "client/cli/options/options.h"
#include "client/cli/options/values.h"
#include "protocol/limits.h"
#include "protocol/number.h"

/* The least --memory-budget as it is written on a command line. */
#define LEAST_MEMORY_OF(mib) #mib "M"
#define LEAST_MEMORY_EXPANDED(mib) LEAST_MEMORY_OF(mib)
#define LEAST_MEMORY LEAST_MEMORY_EXPANDED(PROTOCOL_LEAST_MEMORY_MIB)

static bool apply_vec3(struct options *options, const char *value, double *target, unsigned given,
                       char *why)
{
    char wanted[RANGE_TEXT_BYTES];
    options->given |= given;
    return value_vec3(value, target) ||
           options_refuse(why, "must be three numbers X,Y,Z, each %s",
                          range_text(&RANGES[RANGE_COORDINATE], wanted));
}

static bool apply_server(struct options *options, const char *value, char *why)
{
    (void)why;
    options->server = value;
    return true;
}

static bool apply_ca(struct options *options, const char *value, char *why)
{
    (void)why;
    options->ca = value;
    return true;
}

static bool apply_cert(struct options *options, const char *value, char *why)
{
    (void)why;
    options->cert = value;
    return true;
}

static bool apply_key(struct options *options, const char *value, char *why)
{
    (void)why;
    options->key = value;
    return true;
}

static bool apply_share(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    return options->share = true;
}

static bool apply_weld(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    return options->weld = true;
}

static bool apply_token_file(struct options *options, const char *value, char *why)
{
    (void)why;
    options->token_file = value;
    return true;
}

static bool apply_device(struct options *options, const char *value, char *why)
{
    uint32_t number;
    options->device = value;
    return strcmp(value, "auto") == 0 || strcmp(value, "software") == 0 ||
           strcmp(value, "native") == 0 || value_uint32(value, &number) ||
           options_refuse(why, "must be auto, software, native or a device's number");
}

static bool apply_native_threads(struct options *options, const char *value, char *why)
{
    uint64_t n = 0;
    if (strcmp(value, "auto") != 0 &&
        !number_parse(value, 1, PROTOCOL_MOST_NATIVE_THREADS, false, &n))
        return options_refuse(why, "must be auto or a whole number from 1 to %u",
                              PROTOCOL_MOST_NATIVE_THREADS);
    options->native_threads = (uint32_t)n;
    return true;
}

static bool apply_native_isa(struct options *options, const char *value, char *why)
{
    static const char *const ISAS[] = {PROTOCOL_NATIVE_ISAS};
    options->native_isa = value;
    for (size_t i = 0; i < sizeof(ISAS) / sizeof(*ISAS); i++)
        if (strcmp(value, ISAS[i]) == 0)
            return true;
    return options_refuse(why, "must be auto, v2, v3 or v4");
}

static bool apply_memory_budget(struct options *options, const char *value, char *why)
{
    return number_parse(value, PROTOCOL_LEAST_MEMORY_BYTES, PROTOCOL_MOST_MEMORY_BYTES, true,
                        &options->memory_budget_bytes) ||
           options_refuse(why,
                          "must be bytes, " LEAST_MEMORY " or more, as 4000000000, 800M or 4G");
}

static bool apply_json(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    return options->json = true;
}

static bool apply_quiet(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    return options->quiet = true;
}

static bool apply_reconnect(struct options *options, const char *value, char *why)
{
    return options_whole(&OPTION_RANGES[OPTION_RANGE_RECONNECT], value, &options->reconnect_s, why);
}

bool options_apply_size(struct options *options, const char *value, char *why)
{
    char wanted[RANGE_TEXT_BYTES];
    options->given |= GIVEN_SIZE;
    return value_size(value, &options->request.width_px, &options->request.height_px) ||
           options_refuse(why, "must be WIDTHxHEIGHT, each %s",
                          range_text(&RANGES[RANGE_SIDE], wanted));
}

static bool apply_eye(struct options *options, const char *value, char *why)
{
    return apply_vec3(options, value, options->request.camera.eye, GIVEN_EYE, why);
}

static bool apply_target(struct options *options, const char *value, char *why)
{
    return apply_vec3(options, value, options->request.camera.target, GIVEN_TARGET, why);
}

static bool apply_up(struct options *options, const char *value, char *why)
{
    double *up = options->request.camera.up;
    options->given |= GIVEN_UP;
    char wanted[RANGE_TEXT_BYTES];
    return value_direction(value, up) ||
           options_refuse(why, "must be " VALUE_DIRECTION_WORDS " (each %s)",
                          range_text(&RANGES[RANGE_COORDINATE], wanted));
}

static bool apply_view(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_VIEW;
    return value_view(value, &options->request.camera.view) ||
           options_refuse(why, "must be front, back, left, right, top, bottom or iso");
}

static bool apply_zoom(struct options *options, const char *value, char *why)
{
    struct sheen_camera *camera = &options->request.camera;
    options->given |= GIVEN_ZOOM;
    if (!value_zoom(value, &camera->zoom, camera->zoom_at))
        return options_refuse(why, "must be FACTOR or FACTOR@X,Y, three numbers");
    char text[RANGE_TEXT_BYTES];
    if (!range_holds(&RANGES[RANGE_ZOOM], camera->zoom))
        return options_refuse(why, "FACTOR must be a number %s",
                              range_text(&RANGES[RANGE_ZOOM], text));
    for (int i = 0; i < 2; i++)
        if (!range_holds(&RANGES[RANGE_ZOOM_AT], camera->zoom_at[i]))
            return options_refuse(why, "X and Y are shares of the picture, %s, not pixels",
                                  range_text(&RANGES[RANGE_ZOOM_AT], text));
    return true;
}

static bool apply_fov(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_FOV;
    return options_number(&RANGES[RANGE_FOV], value, &options->request.camera.fov_deg, why);
}

static bool apply_ortho(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_ORTHO;
    return options_number(&RANGES[RANGE_ORTHO_HEIGHT], value, &options->request.camera.ortho_height,
                          why);
}

/* The light that options refer to: the latest. */
static struct sheen_light *latest(struct options *options)
{
    return &options->request.lights[options->request.n_lights - 1];
}

static bool apply_light(struct options *options, const char *value, char *why)
{
    if (options->given & GIVEN_LIGHT) {
        if (!range_holds(&RANGES[RANGE_LIGHTS], options->request.n_lights + 1))
            return options_refuse(why, "there may be %g lights", RANGES[RANGE_LIGHTS].greatest);
        if (!options_check_light(options, why))
            return false;
        options->request.n_lights++;
        *latest(options) = (struct sheen_light){.pattern = SHEEN_PATTERN_DEFAULTS};
        options->given &= ~(unsigned)(GIVEN_LIGHT_CENTER | GIVEN_LIGHT_U | GIVEN_LIGHT_V);
    }
    options->given |= GIVEN_LIGHT;
    char reason[LIGHTS_WHY_BYTES];
    return text_light(value, latest(options), reason) || options_refuse(why, "%s", reason);
}

static bool apply_light_center(struct options *options, const char *value, char *why)
{
    return apply_vec3(options, value, latest(options)->centre, GIVEN_LIGHT_CENTER, why);
}

static bool apply_edge(struct options *options, const char *value, double *edge, unsigned given,
                       char *why)
{
    char wanted[RANGE_TEXT_BYTES];
    return apply_vec3(options, value, edge, given, why) &&
           (range_holds(&RANGES[RANGE_LIGHT_SIDE], range_length(edge)) ||
            options_refuse(why, "must have a length %s",
                           range_text(&RANGES[RANGE_LIGHT_SIDE], wanted)));
}

static bool apply_light_u(struct options *options, const char *value, char *why)
{
    return apply_edge(options, value, latest(options)->u, GIVEN_LIGHT_U, why);
}

static bool apply_light_v(struct options *options, const char *value, char *why)
{
    return apply_edge(options, value, latest(options)->v, GIVEN_LIGHT_V, why);
}

static bool apply_pattern(struct options *options, const char *value, char *why)
{
    char reason[LIGHTS_WHY_BYTES];
    return text_pattern(value, &latest(options)->pattern,
                        &options->image_path[options->request.n_lights - 1], reason) ||
           options_refuse(why, "%s", reason);
}

static bool apply_lines(struct options *options, const char *value, char *why)
{
    char reason[LIGHTS_WHY_BYTES];
    return text_lines(value, &options->request.lines, reason) || options_refuse(why, "%s", reason);
}

static bool apply_line_eye(struct options *options, const char *value, char *why)
{
    char reason[LIGHTS_WHY_BYTES];
    return text_line_eye(value, &options->request.lines, reason) ||
           options_refuse(why, "%s", reason);
}

static bool apply_base(struct options *options, const char *value, char *why)
{
    options->request.has_base = true;
    return value_colour(value, options->request.base) ||
           options_refuse(why, "must be #rrggbb or #rrggbbaa");
}

static bool apply_exact_or_off(const char *value, bool *is_off, char *why)
{
    *is_off = strcmp(value, "off") == 0;
    return *is_off || strcmp(value, "exact") == 0 || options_refuse(why, "must be exact or off");
}

static bool apply_antialias(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_ANTIALIAS;
    return apply_exact_or_off(value, &options->request.aliased, why);
}

static bool apply_filter(struct options *options, const char *value, char *why)
{
    return apply_exact_or_off(value, &options->request.unfiltered, why);
}

static bool apply_miss(struct options *options, const char *value, char *why)
{
    options->request.has_miss = true;
    return value_colour(value, options->request.miss) ||
           options_refuse(why, "must be #rrggbb or #rrggbbaa");
}

static bool apply_empty(struct options *options, const char *value, char *why)
{
    options->request.has_empty = true;
    return value_colour(value, options->request.empty) ||
           options_refuse(why, "must be #rrggbb or #rrggbbaa");
}

static bool apply_surface(struct options *options, const char *value, char *why)
{
    char wanted[RANGE_TEXT_BYTES];
    return value_surface(value, &options->request.surface, &options->request.surface_level) ||
           options_refuse(why, "must be exact, polygon:LEVEL or wireframe:LEVEL, LEVEL %s",
                          range_text(&RANGES[RANGE_LEVEL], wanted));
}

static bool apply_show(struct options *options, const char *value, char *why)
{
    char reason[LIGHTS_WHY_BYTES];
    if (strcmp(value, "breaks") == 0)
        return options_refuse(why, "'sheen breaks MODEL -o FILE.png' paints breaks on the lines");
    return text_show(value, &options->request.show, reason) || options_refuse(why, "%s", reason);
}

static bool apply_show_range(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_SHOW_CURVATURE], value, &options->request.show.range, why);
}

static bool apply_legend(struct options *options, const char *value, char *why)
{
    bool *off = &options->request.show.without_legend;
    options->given |= GIVEN_LEGEND;
    *off = strcmp(value, "off") == 0;
    return *off || strcmp(value, "on") == 0 || options_refuse(why, "must be on or off");
}

static bool apply_class(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_CLASS;
    return value_class(value, &options->request.request_class) ||
           options_refuse(why, "must be interactive, still or batch");
}

static bool apply_deadline(struct options *options, const char *value, char *why)
{
    return options_whole(&RANGES[RANGE_DEADLINE], value, &options->request.deadline_ms, why);
}

static bool apply_jpeg_quality(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_JPEG;
    return options_whole(&RANGES[RANGE_JPEG_QUALITY], value, &options->request.jpeg_quality, why);
}

static bool apply_jpeg_subsampling(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_JPEG;
    return value_subsampling(value, &options->request.jpeg_subsampling) ||
           options_refuse(why, "must be 444, 422 or 420");
}

bool options_check_jpeg(const struct options *options, char *why)
{
    return !(options->given & GIVEN_JPEG) || options->request.format == SHEEN_FORMAT_JPEG ||
           options_refuse(why, "--jpeg-quality and --jpeg-subsampling need an output that ends in "
                               ".jpg or .jpeg");
}

const struct option_row OPTIONS_JPEG[] = {
    {"jpeg-quality", 0, "N",
     "quality of a .jpg file on libjpeg's scale, {}; lower\n"
     "values give smaller files (default: 95)",
     apply_jpeg_quality, NULL},
    {"jpeg-subsampling", 0, "KIND",
     "colour resolution of a .jpg file: 444, one sample for each pixel; 422, one for\n"
     "two pixels side by side; 420, one for two by two. Less colour gives smaller\n"
     "files and less sharp coloured edges (default: 444)",
     apply_jpeg_subsampling, "444 422 420"},
    {0},
};

const struct option_row OPTIONS_SCHEDULE[] = {
    {"class", 0, "CLASS",
     "priority at a busy daemon: interactive comes first, then still, then batch;\n"
     "each of the last two keeps a fifth of the device's time (default: still;\n"
     "stream: interactive)",
     apply_class, "interactive still batch"},
    {"deadline", 0, "MS",
     "give up the frame unless it begins to be drawn within this time after the\n"
     "daemon has read the request, {} (default: none)",
     apply_deadline, NULL},
    {0},
};

const struct option_row OPTIONS_DEADLINE[] = {
    {"deadline", 0, "MS",
     "give up after this time, {}\n(default: none). It is checked between steps of "
     "some\nmilliseconds: what is computed within the first of them is answered",
     apply_deadline, NULL},
    {0},
};

const struct option_row OPTIONS_MODEL[] = {
    {"weld", 0, NULL,
     "join vertices of an OBJ file at exactly equal positions; glTF meshes are\n"
     "always joined, USD meshes never. The line 't weld 0/0/0' is appended to the\n"
     "file, and the model is identified by the SHA-256 of both",
     apply_weld, NULL},
    {0},
};

const struct option_row OPTIONS_COMMON[] = {
    {"server", 0, "ADDRESS",
     "address of a running daemon: unix:PATH, tcp:HOST:PORT or tls:HOST:PORT\n"
     "(default: $SHEEN_SERVER, else a private daemon for this command)",
     apply_server, NULL},
    {"ca", 0, "FILE",
     "PEM file with the authority that must have issued the certificate of a TLS\n"
     "server (default: the authorities that the system trusts)",
     apply_ca, NULL},
    {"cert", 0, "FILE", "PEM file with the certificate to present to a TLS server; with --key",
     apply_cert, NULL},
    {"key", 0, "FILE", "PEM file with the key of --cert", apply_key, NULL},
    {"token-file", 0, "FILE",
     "file whose first line is the token to present to a TLS server (default:\n"
     "$SHEEN_TOKEN_FILE, else none)",
     apply_token_file, NULL},
    {"share", 0, NULL,
     "other users may use the uploaded files, too, if they know their SHA-256\n"
     "(default: only this user)",
     apply_share, NULL},
    {"device", 0, "DEVICE",
     "device of the private daemon: auto (default), a GPU if there is one, else the\n"
     "processors; software or native, the processors without OpenGL; or the number\n"
     "of an EGL device, from 0, which includes Mesa's software device",
     apply_device, "auto software native"},
    {"native-threads", 0, "N",
     "threads of the private daemon that draw if there is no GPU, 1 to 64, or auto\n"
     "(default), one for each available processor. The number does not change\n"
     "pictures",
     apply_native_threads, "auto"},
    {"native-isa", 0, "ISA",
     "x86-64 instructions with which the private daemon draws if there is no GPU: v2\n"
     "(SSE4.2), v3 (AVX2 and FMA), v4 (AVX-512), or auto (default), the best that the\n"
     "processor has. Pictures of different sets differ by rounding",
     apply_native_isa, "auto v2 v3 v4"},
    {"memory-budget", 0, "BYTES",
     "memory of the private daemon for the model, its tables, images and frames\n"
     "together, in main memory and on the device, at least " LEAST_MEMORY "; for example 800M or\n"
     "16G (default: half of the memory that the machine has or that the control\n"
     "group allows)",
     apply_memory_budget, NULL},
    {"quiet", 'q', NULL, "no progress, summary, notices or warnings on standard error", apply_quiet,
     NULL},
    {0},
};

const struct option_row OPTIONS_RECONNECT[] = {
    {"reconnect", 0, "SECONDS",
     "how long to try to connect again when the server of --server shuts down or the\n"
     "connection breaks, {} (default: 30; 0: never).\n"
     "Requests without an answer are then sent again. A server that never answered,\n"
     "and a private daemon, are not waited for",
     apply_reconnect, NULL},
    {0},
};

const struct option_row OPTIONS_OUTPUT[] = {
    {"json", 0, NULL, "print one JSON object on standard output", apply_json, NULL},
    {"help", 'h', NULL, "print the options with their ranges and defaults", NULL, NULL},
    {0},
};

const struct option_row OPTIONS_SIZE[] = {
    {"size", 0, "WxH",
     "width and height of the picture (default: 1280x720),\n"
     "each {} (JPEG: {}); the\n"
     "device's limit may be lower",
     options_apply_size, NULL},
    {0},
};

const struct option_row OPTIONS_SCENE[] = {
    {"eye", 0, "X,Y,Z",
     "position of the camera, in the model's units; with --target\n"
     "(default: a camera that frames the model)",
     apply_eye, NULL},
    {"target", 0, "X,Y,Z",
     "point that the camera looks at; without --eye the default camera keeps its\n"
     "position and turns to this point",
     apply_target, NULL},
    {"view", 0, "NAME",
     "frame the model from the front, back, left, right, top, bottom or iso (equal\n"
     "angles to all axes). If up is z, the front is at -y and the right at x; if up\n"
     "is y, at z and x. Not with --eye (default: from above the front right)",
     apply_view, "front back left right top bottom iso"},
    {"zoom", 0, "FACTOR@X,Y",
     "magnify the picture by FACTOR, {}, with the same eye,\n"
     "so that no line moves on the surface, around the place X,Y of the picture:\n"
     "0,0 is its top left, 1,1 its bottom right (default: 0.5,0.5)",
     apply_zoom, NULL},
    {"up", 0, "X,Y,Z",
     "up direction of the model, for camera and light: X,Y,Z, or x, y, z, -x, -y, -z\n"
     "(default: the file's, which is y for glTF and upAxis for USD; else a guess: z,\n"
     "or y if the model is thinner in y by more than 1 %. Give it where the guess is\n"
     "wrong, as for an upright door)",
     apply_up, "x y z -x -y -z"},
    {"fov", 0, "DEG",
     "vertical field of view, {} (default: 35);\n"
     "without --eye and --target the default camera keeps its position",
     apply_fov, NULL},
    {"ortho", 0, "HEIGHT",
     "orthographic camera: height of the picture in the model's units,\n"
     "{}; without --eye and --target it looks in the\n"
     "direction of the default camera",
     apply_ortho, NULL},
    {"lines", 0, "FAMILY",
     "kind of lines: reflection, highlight, isophote, zebra or environment, the last\n"
     "three optionally with a direction :X,Y,Z; 'sheen lights' explains them\n"
     "(default: reflection)",
     apply_lines, "reflection highlight isophote zebra environment"},
    {"light", 0, "KIND",
     "kind of light: rectangle, plane, tunnel or sphere, the first two optionally\n"
     "with :one-sided. Each --light after the first begins another light below the\n"
     "earlier ones (default: tunnel; rectangle if the light is placed)",
     apply_light, "rectangle plane tunnel sphere rectangle:one-sided plane:one-sided"},
    {"light-center", 0, "X,Y,Z",
     "centre of the latest light; with --light-u and --light-v (default: placed by\n"
     "the model and --up only, not by the camera: a tunnel about the longer\n"
     "horizontal side, which every reflected ray meets; a rectangle or plane above\n"
     "the model)",
     apply_light_center, NULL},
    {"light-u", 0, "X,Y,Z",
     "edge u of the latest light, along which stripes are counted; the radius of a\n"
     "tunnel; its length is {}",
     apply_light_u, NULL},
    {"light-v", 0, "X,Y,Z",
     "edge v of the latest light, not parallel to --light-u; the axis of a tunnel or\n"
     "sphere; its length is {}",
     apply_light_v, NULL},
    {"pattern", 0, "PATTERN",
     "pattern of the latest light: stripes, lattice, circles, lines, rainbow or\n"
     "distance, optionally with :count=40,duty=0.5,...; or image:FILE (PNG, JPEG,\n"
     "TIFF, OpenEXR, HDR, GIF, BMP, TGA, WebP, PNM); 'sheen patterns' lists all\n"
     "parts (default: stripes:count=40,duty=0.5)",
     apply_pattern, "stripes lattice circles rainbow distance"},
    {"line-eye", 0, "EYE",
     "eye for which the lines are computed: camera, a point X,Y,Z, or dir:X,Y,Z for\n"
     "an eye at infinity that looks in this direction. A fixed eye holds the lines\n"
     "while the camera moves (default: camera)",
     apply_line_eye, "camera"},
    {0},
};

const struct option_row OPTIONS_COLOURS[] = {
    {"base", 0, "COLOUR",
     "colour of the shaded surface, visible through patterns with an opacity below 1;\n"
     "transparent colours of a pattern leave the picture transparent (default:\n"
     "#b3b8bf)",
     apply_base, NULL},
    {"antialias", 0, "KIND",
     "antialiasing of edges: exact, pixels mix what they see, or off, each pixel\n"
     "shows what its centre sees, which is faster; lines are averaged in both cases\n"
     "(default: exact; off with --filter off)",
     apply_antialias, "exact off"},
    {"filter", 0, "KIND",
     "averaging of lines: exact, over each pixel, or off, one sample for each pixel,\n"
     "of lines and edges (default: exact)",
     apply_filter, "exact off"},
    {"miss", 0, "COLOUR",
     "colour where the ray meets no light: #rrggbb or #rrggbbaa\n"
     "(default: #29303b, a dark blue-grey)",
     apply_miss, NULL},
    {"empty", 0, "COLOUR",
     "colour where no surface is visible: #rrggbb or #rrggbbaa (default: #808080, grey)",
     apply_empty, NULL},
    {0},
};

const struct option_row OPTIONS_SURFACE[] = {
    {"surface", 0, "KIND",
     "surface to draw: exact, the limit surface; or, for comparison, polygon:LEVEL,\n"
     "the cage subdivided LEVEL times ({}) with interpolated normals, as\n"
     "a graphics card draws it, or wireframe:LEVEL, the edges of those polygons\n"
     "(default: exact)",
     apply_surface, "exact polygon:1 polygon:2 polygon:3 wireframe:1 wireframe:2 wireframe:3"},
    {"show", 0, "KIND",
     "content of the picture: lines, or false colour with a legend: curvature (the\n"
     "principal curvature with the larger magnitude), gaussian, mean, normal, ptex,\n"
     "or draft:X,Y,Z (draft angle in degrees for the direction of pull X,Y,Z, or a\n"
     "word as for --up) (default: lines)",
     apply_show, "curvature gaussian mean normal ptex draft:z lines"},
    {"show-range", 0, "VALUE",
     "value at which the colours of --show end, on both sides: 1/unit, for gaussian\n"
     "1/unit^2, {} (default: 98 % of the pixels are\n"
     "inside; stream: of the first frame, for all frames); for draft\n"
     "{} (default: 3)",
     apply_show_range, NULL},
    {"legend", 0, "on|off",
     "legend of --show in the lower right corner of the picture (default: on)", apply_legend,
     "on off"},
    {0},
};
