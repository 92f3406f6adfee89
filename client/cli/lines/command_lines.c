/* sheen lines: the lines of a surface as curves. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "client/cli/base/failure.h"
#include "client/cli/client.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/options/values.h"
#include "client/cli/lines/curve_files.h"
#include "client/cli/output/scene_json.h"

#define SCHEMA "sheen-lines-1" /* client/schema/lines-1.json */
enum { POSITION_BIT = 1, NORMAL_BIT = 2 };

enum curve_format { FORMAT_SVG, FORMAT_JSON, FORMAT_CSV, FORMAT_DXF, N_FORMATS };
static const char *const ENDINGS[N_FORMATS] = {".svg", ".json", ".csv", ".dxf"};

/* What the command has made. */
struct traced {
    struct sheen_curves curves;
    struct sheen_frame frame; /* planes P and N of the camera */
    struct projection projection;
    struct curve_part *parts;
    size_t n_parts;
};

/* The format by the file's ending; N_FORMATS: none. */
static enum curve_format format_of(const char *path)
{
    size_t length = strlen(path);
    int format = 0;
    while (format < N_FORMATS &&
           (length <= strlen(ENDINGS[format]) ||
            strcasecmp(path + length - strlen(ENDINGS[format]), ENDINGS[format]) != 0))
        format++;
    return (enum curve_format)format;
}

/* --- asking */

static enum sheen_status trace(struct client *client, const struct options *options,
                               struct sheen_curves *curves)
{
    struct sheen_request request = options->request;
    struct sheen_curve_options asked = options->curve_options;
    enum sheen_status status;
    asked.at = options->places;
    do {
        memcpy(request.model_id, client->model_id, SHEEN_ID_BYTES);
        status = sheen_trace_lines(client->session, &request, &asked, &client->report, curves,
                                   &client->error);
    } while (status && client_resume(client, options, &status));
    if (status == SHEEN_LATE && request.deadline_ms)
        failure_set(&client->error, status,
                    "the lines were not traced within --deadline %u (milliseconds): give them more "
                    "time, or ask again when the daemon has less to do",
                    request.deadline_ms);
    return status;
}

/* Draws what the camera sees, and cuts the curves by it. */
static enum sheen_status look(struct client *client, const struct options *options,
                              struct traced *traced)
{
    struct sheen_request request = options->request;
    request.camera = traced->curves.camera;
    request.planes = SHEEN_PLANE_POSITION | SHEEN_PLANE_NORMAL;
    request.format = SHEEN_FORMAT_RAW;
    enum sheen_status status = client_render(client, options, &request, &traced->frame);
    if (status)
        return status;
    const struct view_planes planes = {
        .width_px = traced->frame.width_px,
        .height_px = traced->frame.height_px,
        .position = (const float(*)[3])traced->frame.plane[POSITION_BIT],
        .normal = (const float(*)[3])traced->frame.plane[NORMAL_BIT],
    };
    projection_init(&traced->projection, &traced->curves.camera, planes.width_px, planes.height_px);
    traced->parts = curve_parts(&traced->curves, &traced->projection, &planes, &traced->n_parts);
    return traced->parts ? SHEEN_OK
                         : failure_set(&client->error, SHEEN_NO_MEMORY,
                                       "no memory for the visible parts of curves");
}

/* --- JSON */

static void json_uv(struct json *json, const double uv[2])
{
    json_array_begin(json, "uv");
    json_double(json, NULL, uv[0]);
    json_double(json, NULL, uv[1]);
    json_array_end(json);
}

static void json_point(struct json *json, const struct sheen_curve_point *point)
{
    json_object_begin(json, NULL);
    json_vec3(json, "position", point->position);
    json_vec3(json, "normal", point->normal);
    json_vec3(json, "along", point->along);
    json_uint(json, "face", point->face);
    json_uv(json, point->uv);
    json_double(json, "residual", point->residual);
    json_double(json, "length", point->length);
    json_object_end(json);
}

/* The visible parts of a curve: from and to, as numbers of points. */
static void json_visible(struct json *json, const struct traced *traced, uint32_t index)
{
    json_array_begin(json, "visible");
    for (size_t i = 0; i < traced->n_parts; i++) {
        const struct curve_part *part = &traced->parts[i];
        if (part->curve != index || !part->visible)
            continue;
        json_array_begin(json, NULL);
        json_double(json, NULL, part->from);
        json_double(json, NULL, part->to);
        json_array_end(json);
    }
    json_array_end(json);
}

static void json_curve(struct json *json, const struct traced *traced, uint32_t index)
{
    const struct sheen_curve *curve = &traced->curves.curves[index];
    json_object_begin(json, NULL);
    json_uint(json, "light", curve->light + 1);
    json_uint(json, "line", curve->line + 1);
    json_double(json, "place", curve->place);
    json_bool(json, "closed", curve->is_closed);
    json_double(json, "length", curve->length);
    json_visible(json, traced, index);
    json_array_begin(json, "points");
    for (size_t k = 0; k < curve->n_points; k++)
        json_point(json, &curve->points[k]);
    json_array_end(json);
    json_object_end(json);
}

static void json_mark(struct json *json, const struct sheen_curve_mark *mark)
{
    json_object_begin(json, NULL);
    json_text(json, "kind", mark->kind == SHEEN_CURVE_FLAT ? "flat" : "singular");
    json_uint(json, "light", mark->light + 1);
    json_uint(json, "line", mark->line + 1);
    json_vec3(json, "position", mark->position);
    json_vec3(json, "normal", mark->normal);
    json_uint(json, "face", mark->face);
    json_uv(json, mark->uv);
    json_object_end(json);
}

/* The object of the file, with points, and of standard output, without. */
static void print_json(struct json *json, const struct options *options,
                       const struct client *client, const struct traced *traced, bool with_points)
{
    const struct sheen_curves *curves = &traced->curves;
    uint32_t n_closed = 0;
    double length = 0;
    for (uint32_t i = 0; i < curves->n_curves; i++) {
        n_closed += curves->curves[i].is_closed;
        length += curves->curves[i].length;
    }
    json_object_begin(json, NULL);
    json_text(json, "schema", SCHEMA);
    json_text(json, "model", options->model);
    json_hex(json, "model_sha256", client->model_id, SHEEN_ID_BYTES);
    json_bool(json, "weld", options->weld);
    json_text(json, "server", curves->server);
    json_uint(json, "total_us", curves->total_us);
    json_text(json, "unit", "the file's own");
    json_double(json, "diagonal", curves->diagonal);
    json_double(json, "tolerance", curves->tolerance);
    json_bool(json, "silhouettes", options->curve_options.silhouettes);
    json_object_begin(json, "counts");
    json_uint(json, "curves", curves->n_curves);
    json_uint(json, "closed", n_closed);
    json_uint(json, "points", curves->n_points);
    json_uint(json, "marks", curves->n_marks);
    json_object_end(json);
    json_double(json, "length", length);
    if (with_points) {
        json_array_begin(json, "curves");
        for (uint32_t i = 0; i < curves->n_curves; i++)
            json_curve(json, traced, i);
        json_array_end(json);
    }
    json_array_begin(json, "marks");
    for (uint32_t i = 0; i < curves->n_marks; i++)
        json_mark(json, &curves->marks[i]);
    json_array_end(json);
    json_uint(json, "width", traced->projection.width_px);
    json_uint(json, "height", traced->projection.height_px);
    scene_json_lines(json, &curves->camera, &curves->lines, curves->lights, curves->n_lights);
    json_object_end(json);
}

/* --- the file */

static bool write_text(FILE *out, const struct options *options, const struct client *client,
                       const struct traced *traced)
{
    const struct curve_drawing drawing = {&traced->curves, traced->parts, traced->n_parts,
                                          &traced->projection, options->visible_only};
    struct json json = {.out = out};
    switch (format_of(options->output)) {
    case FORMAT_SVG:
        return curve_write_svg(out, &drawing);
    case FORMAT_DXF:
        curve_write_dxf(out, &drawing);
        return true;
    case FORMAT_CSV:
        curve_write_csv(out, &drawing);
        return true;
    default:
        print_json(&json, options, client, traced, true);
        return json_finish(&json);
    }
}

static enum sheen_status write_file(struct client *client, const struct options *options,
                                    const struct traced *traced)
{
    char *text = NULL;
    size_t n_bytes = 0;
    FILE *out = open_memstream(&text, &n_bytes);
    bool ok = out && write_text(out, options, client, traced);
    if (out && fclose(out) != 0)
        ok = false;
    enum sheen_status status =
        ok ? file_write(options->output, (const uint8_t *)text, n_bytes, &client->error)
           : failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for %s", options->output);
    free(text);
    return status;
}

static void print_notices(const struct options *options, const struct sheen_curves *curves)
{
    if (options->quiet || options->json)
        return;
    if (curves->n_marks > 0)
        fprintf(stderr,
                "sheen: %s: %u %s where the course of a line is not decided; --json lists them\n",
                options->model, curves->n_marks, value_noun(curves->n_marks, "place", "places"));
    if (curves->n_curves == 0)
        fprintf(stderr, "sheen: %s: %s\n", options->model,
                options->curve_options.silhouettes ? "no silhouettes" : "no lines are met");
}

/* The number of lines that have a curve; the curves of a line stand together. */
static uint32_t lines_of(const struct sheen_curves *curves)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < curves->n_curves; i++)
        n += i == 0 || curves->curves[i].line != curves->curves[i - 1].line;
    return n;
}

static void print_summary(const struct options *options, const struct sheen_curves *curves)
{
    if (options->quiet)
        return;
    fprintf(stderr, "%s: %u ", options->output, curves->n_curves);
    if (options->curve_options.silhouettes)
        fputs(value_noun(curves->n_curves, "silhouette", "silhouettes"), stderr);
    else
        fprintf(stderr, "%s of %u %s", value_noun(curves->n_curves, "curve", "curves"),
                lines_of(curves), value_noun(lines_of(curves), "line", "lines"));
    fprintf(stderr, ", %u undecided %s, %.0f ms\n", curves->n_marks,
            value_noun(curves->n_marks, "place", "places"), (double)curves->total_us / 1e3);
}

static enum sheen_status print(struct client *client, const struct options *options,
                               const struct traced *traced)
{
    progress_clear(&client->progress);
    enum sheen_status status = write_file(client, options, traced);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, options, client, traced, false);
        status = client_finish_json(client, &json);
    }
    if (!status)
        print_notices(options, &traced->curves);
    if (!status)
        print_summary(options, &traced->curves);
    return status;
}

static int run(const struct options *options)
{
    struct client client = {.session = NULL};
    struct traced traced = {.curves = SHEEN_CURVES_DEFAULTS, .frame = SHEEN_FRAME_DEFAULTS};
    enum sheen_status status = file_check_writable(options->output, &client.error);
    if (status)
        return client_finish(&client, status);
    status = client_init(&client, options);
    if (!status)
        status = trace(&client, options, &traced.curves);
    if (!status)
        status = look(&client, options, &traced);
    if (!status)
        status = print(&client, options, &traced);
    free(traced.parts);
    sheen_frame_finish(&traced.frame);
    sheen_curves_finish(&traced.curves);
    return client_finish(&client, status);
}

/* --- options */

static bool apply_output(struct options *options, const char *value, char *why)
{
    options->output = value;
    return format_of(value) < N_FORMATS ||
           options_refuse(why, "must end in .svg, .json, .csv or .dxf");
}

static bool apply_at(struct options *options, const char *value, char *why)
{
    const struct range *range = &RANGES[RANGE_LINE_PLACE];
    uint32_t *n = &options->curve_options.n_at;
    for (*n = 0; *value; (*n)++) {
        size_t length = strcspn(value, ",");
        char number[40];
        if (*n == SHEEN_MAX_CURVE_PLACES)
            return options_refuse(why, "has more than %d places", SHEEN_MAX_CURVE_PLACES);
        if (length >= sizeof(number))
            return options_refuse(why, "must be numbers with commas between");
        snprintf(number, sizeof(number), "%.*s", (int)length, value);
        if (!options_number(range, number, &options->places[*n], why))
            return false;
        value += length + (value[length] == ',');
    }
    return *n > 0 || options_refuse(why, "must be numbers with commas between");
}

static bool apply_tolerance(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_TOLERANCE], value, &options->curve_options.tolerance, why);
}

static bool apply_visible_only(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    options->visible_only = true;
    return true;
}

static bool apply_silhouettes(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    options->curve_options.silhouettes = true;
    return true;
}

static bool check(struct options *options, char *why)
{
    if (!options->output)
        return options_refuse(why, "-o FILE is missing");
    if (options->curve_options.silhouettes && options->curve_options.n_at > 0)
        return options_refuse(why, "--at is for lines; silhouettes have no places");
    return options_check_scene(options, why);
}

static const struct option_row ROWS[] = {
    {"output", 'o', "FILE",
     "file to write: .svg (cubic paths in pixels of the picture, a group for each\n"
     "light and line, hidden parts dashed), .json or .csv (all points with normal,\n"
     "tangent, face, u and v), or .dxf (R12, 3-D polylines, a layer for each light)",
     apply_output, NULL},
    {"at", 0, "S,S,...",
     "places of lines on each light, {};\n"
     "0 to 1 is its width (default: those of a pattern of lines; of stripes and\n"
     "lattices the middle of each bright stripe)",
     apply_at, NULL},
    {"tolerance", 0, "LENGTH",
     "greatest distance of a curve from the chords between its points,\n"
     "{} of the model (default: 1e-5 of the diagonal of\n"
     "the model's box)",
     apply_tolerance, NULL},
    {"silhouettes", 0, NULL,
     "trace the silhouettes for the line eye, instead of lines; the border of an open\n"
     "surface is none",
     apply_silhouettes, NULL},
    {"visible-only", 0, NULL, "leave out what the camera does not see", apply_visible_only, NULL},
    {0},
};

static const struct option_row *const TABLES[] = {
    ROWS,           OPTIONS_DEADLINE,  OPTIONS_SIZE,   OPTIONS_SCENE, OPTIONS_MODEL,
    OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_LINES = {
    .name = "lines",
    .arguments = "MODEL -o FILE [option]...",
    .summary =
        "Traces the lines that 'sheen render' draws as curves on the surface itself. No line is\n"
        "lost, however small; a place where the course of a line cannot be decided is reported.\n"
        "The camera decides which parts are visible, and is the eye of the lines.",
    .tables = TABLES,
    .examples =
        "  sheen lines hood.obj -o hood.svg --visible-only\n"
        "  sheen lines hood.obj -o hood.dxf --light plane --pattern lines:at=0.25/0.5/0.75\n"
        "  sheen lines hood.obj -o hood.csv --lines zebra --at 0.3,0.5,0.7 --tolerance 0.01\n"
        "  sheen lines hood.obj -o outline.svg --silhouettes --line-eye camera\n",
    .takes_model = true,
    .check = check,
    .codes = CODE_FILES | CODE_SERVER | CODE_LATE,
    .run = run,
};
