/* The options that several commands share. */
#include <string.h>

#include "client/cli/options/lights_text.h"
#include "client/cli/options/options.h"
#include "client/cli/options/values.h"
#include "protocol/limits.h"
#include "protocol/number.h"

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
           options_refuse(why, "must be bytes, 4M or more, as 4000000000, 800M or 4G");
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
     "of a .jpg, as libjpeg has it: {}, the lower the\n"
     "smaller the file (default: 95)",
     apply_jpeg_quality, NULL},
    {"jpeg-subsampling", 0, "KIND",
     "of a .jpg's colour: 444, one sample for each pixel, 422, for two side by\n"
     "side, or 420, for two by two: smaller files, coloured edges less sharp\n"
     "(default: 444)",
     apply_jpeg_subsampling, "444 422 420"},
    {0},
};

const struct option_row OPTIONS_SCHEDULE[] = {
    {"class", 0, "CLASS",
     "what the daemon puts first when it has many: interactive, then still, then\n"
     "batch, of which the last two keep a fifth of its time each (default: still;\n"
     "stream: interactive)",
     apply_class, "interactive still batch"},
    {"deadline", 0, "MS",
     "of no use later than this after the daemon has read the request,\n"
     "{} (default: none)",
     apply_deadline, NULL},
    {0},
};

const struct option_row OPTIONS_MODEL[] = {
    {"weld", 0, NULL,
     "joins an OBJ file's vertices at exactly equal positions, as glTF's are inside\n"
     "a mesh anyway; the file is sent with the line 't weld 0/0/0' behind it and is\n"
     "named by the SHA-256 of both",
     apply_weld, NULL},
    {0},
};

const struct option_row OPTIONS_COMMON[] = {
    {"server", 0, "ADDRESS",
     "a running daemon: unix:PATH, tcp:HOST:PORT or tls:HOST:PORT (default:\n"
     "SHEEN_SERVER from the environment, else a private daemon for this command)",
     apply_server, NULL},
    {"ca", 0, "FILE",
     "PEM, the authority of a tls: server's certificate (default: those the system\n"
     "trusts)",
     apply_ca, NULL},
    {"cert", 0, "FILE", "PEM, the certificate to show to a tls: server; with --key", apply_cert,
     NULL},
    {"key", 0, "FILE", "PEM, its key", apply_key, NULL},
    {"token-file", 0, "FILE",
     "a file whose first line is the token to show to a tls: server (default:\n"
     "SHEEN_TOKEN_FILE from the environment, else none)",
     apply_token_file, NULL},
    {"share", 0, NULL,
     "whoever knows the SHA-256 of what is uploaded may use it too (default: this\n"
     "user alone)",
     apply_share, NULL},
    {"device", 0, "DEVICE",
     "of the private daemon: auto (default), a GPU when there is one, else native;\n"
     "software or native, processors without OpenGL; or an EGL device's number from\n"
     "0, Mesa's software device among them",
     apply_device, "auto software native"},
    {"native-threads", 0, "N",
     "of the private daemon: threads that draw on the native device, 1 to 64, or\n"
     "auto (default), one for each processor that it may use. Pictures are the same\n"
     "for any number",
     apply_native_threads, "auto"},
    {"native-isa", 0, "ISA",
     "of the private daemon: instructions that the native device draws by, v2\n"
     "(SSE4.2), v3 (AVX2 and FMA) or v4 (AVX-512) of x86-64, or auto (default), the\n"
     "widest that the processor has. Pictures of two sets differ by rounding",
     apply_native_isa, "auto v2 v3 v4"},
    {"memory-budget", 0, "BYTES",
     "of the private daemon: most that the model, its tables, images and frames may\n"
     "take together, in main memory and on the device, 4M or more, as 800M or 16G\n"
     "(default: half of the memory that the machine has, or its control group may\n"
     "take)",
     apply_memory_budget, NULL},
    {"quiet", 'q', NULL, "no progress, summary, notices or warnings on standard error", apply_quiet,
     NULL},
    {0},
};

const struct option_row OPTIONS_RECONNECT[] = {
    {"reconnect", 0, "SECONDS",
     "how long to go on connecting when the server of --server shuts down or breaks\n"
     "the connection: what has no answer is asked again of the one that takes its\n"
     "place, {} (default: 30; 0: give up at once). A server that\n"
     "was never there, and a private daemon, are not waited for",
     apply_reconnect, NULL},
    {0},
};

const struct option_row OPTIONS_OUTPUT[] = {
    {"json", 0, NULL, "one JSON object on standard output", apply_json, NULL},
    {"help", 'h', NULL, "shows the options with their ranges and defaults", NULL, NULL},
    {0},
};

const struct option_row OPTIONS_SIZE[] = {
    {"size", 0, "WxH",
     "width and height of the picture (default: 1280x720),\n"
     "each {} (JPEG: {}); a device's\n"
     "own limit may be lower",
     options_apply_size, NULL},
    {0},
};

const struct option_row OPTIONS_SCENE[] = {
    {"eye", 0, "X,Y,Z",
     "where the camera stands, in the model's units; with --target\n"
     "(default: a camera that frames the model)",
     apply_eye, NULL},
    {"target", 0, "X,Y,Z",
     "the point it looks at; without --eye the default camera stays where it is\n"
     "and turns to it",
     apply_target, NULL},
    {"view", 0, "NAME",
     "the model framed from the front, back, left, right, top, bottom or iso (all\n"
     "axes alike): with z up the front is at -y and the right at x, with y up at z\n"
     "and x; not with --eye (default: from above the front right)",
     apply_view, "front back left right top bottom iso"},
    {"zoom", 0, "FACTOR@X,Y",
     "a closer look from the same eye, so that lines stay on the surface: FACTOR\n"
     "{} times as close at the place X,Y of the picture,\n"
     "0,0 its top left and 1,1 its bottom right (default: 0.5,0.5, the middle)",
     apply_zoom, NULL},
    {"up", 0, "X,Y,Z",
     "which way is up, for the camera and for the light: a direction X,Y,Z or x, y,\n"
     "z, -x, -y, -z, +x and so on (default: what the file says, glTF: y; else z, or y where the "
     "model is\n"
     "thinner in y by more than 1 %: where that is wrong, as for a door that stands,\n"
     "say it)",
     apply_up, "x y z -x -y -z"},
    {"fov", 0, "DEG",
     "vertical field of view, {} (default: 35);\n"
     "without --eye and --target it zooms from where the default camera stands",
     apply_fov, NULL},
    {"ortho", 0, "HEIGHT",
     "orthographic: units from top to bottom of the picture,\n"
     "{}; without --eye and --target it looks at the\n"
     "model as the default camera does",
     apply_ortho, NULL},
    {"lines", 0, "FAMILY",
     "reflection, highlight, isophote, zebra or environment, the last three with\n"
     ":X,Y,Z as wanted; sheen lights explains them (default: reflection)",
     apply_lines, "reflection highlight isophote zebra environment"},
    {"light", 0, "KIND",
     "rectangle, plane, tunnel or sphere, the first two with :one-sided as wanted;\n"
     "each --light after the first begins another, over which the earlier lie\n"
     "(default: tunnel; rectangle when the light is placed)",
     apply_light, "rectangle plane tunnel sphere rectangle:one-sided plane:one-sided"},
    {"light-center", 0, "X,Y,Z",
     "the middle of the latest light; with --light-u and --light-v (default: by the\n"
     "model and --up alone, whatever the camera: a tunnel about the longer horizontal\n"
     "side, which every reflected ray meets; a rectangle or plane above the model)",
     apply_light_center, NULL},
    {"light-u", 0, "X,Y,Z",
     "its edge that stripes are counted along; a tunnel's radius; its length is\n"
     "{}",
     apply_light_u, NULL},
    {"light-v", 0, "X,Y,Z",
     "its other edge, not along --light-u; the axis of a tunnel or sphere; its\n"
     "length is {}",
     apply_light_v, NULL},
    {"pattern", 0, "PATTERN",
     "of the latest light: stripes, lattice, circles, lines, rainbow or distance,\n"
     "then :count=40,duty=0.5,... as far as wanted, or image:FILE (PNG,\n"
     "JPEG, TIFF, OpenEXR, HDR, GIF, BMP, TGA, WebP, PNM); sheen patterns lists\n"
     "all parts (default: stripes:count=40,duty=0.5)",
     apply_pattern, "stripes lattice circles rainbow distance"},
    {"line-eye", 0, "EYE",
     "whose view the lines are computed for: camera, a point X,Y,Z, or dir:X,Y,Z\n"
     "for an eye at infinity that looks that way; holds the lines while the\n"
     "camera moves (default: camera)",
     apply_line_eye, "camera"},
    {"base", 0, "COLOUR",
     "the surface, shaded, seen through patterns whose opacity is below 1 (clear\n"
     "colours of a pattern leave the picture clear) (default: #b3b8bf)",
     apply_base, NULL},
    {"antialias", 0, "KIND",
     "exact: pixels at edges show shares of what they see, or off: each shows what\n"
     "its centre sees, which is faster; lines stay averaged (default: exact, with\n"
     "--filter off: off)",
     apply_antialias, "exact off"},
    {"filter", 0, "KIND",
     "exact: lines averaged over each pixel's footprint, or off: one sample a\n"
     "pixel, of lines and edges (default: exact)",
     apply_filter, "exact off"},
    {"miss", 0, "COLOUR",
     "where no light is met: #rrggbb or #rrggbbaa\n"
     "(default: #29303b, a dark blue-grey)",
     apply_miss, NULL},
    {"empty", 0, "COLOUR", "where no surface is hit: #rrggbb or #rrggbbaa (default: #808080, grey)",
     apply_empty, NULL},
    {0},
};

const struct option_row OPTIONS_SURFACE[] = {
    {"surface", 0, "KIND",
     "exact (default): the limit surface; for comparison polygon:LEVEL, the cage\n"
     "subdivided LEVEL times ({}), normals interpolated as a graphics\n"
     "card does, or wireframe:LEVEL, the edges of those polygons",
     apply_surface, "exact polygon:1 polygon:2 polygon:3 wireframe:1 wireframe:2 wireframe:3"},
    {"show", 0, "KIND",
     "false colour with a legend: curvature (the principal curvature of larger\n"
     "magnitude), gaussian, mean, normal, ptex, draft:X,Y,Z (degrees to the pull\n"
     "direction X,Y,Z, or a word as for --up), or lines (default: lines)",
     apply_show, "curvature gaussian mean normal ptex draft:z lines"},
    {"show-range", 0, "VALUE",
     "where the colours of --show end, both ways: 1/unit, gaussian 1/unit^2,\n"
     "{} (default: 98 of 100 pixels are inside,\n"
     "stream: of the first frame's, for all frames); draft\n"
     "{} (default: 3)",
     apply_show_range, NULL},
    {"legend", 0, "on|off", "of --show, over the lower right corner of the picture (default: on)",
     apply_legend, "on off"},
    {0},
};
