/* sheen breaks: where the lines of a surface break, and by how much. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "client/cli/base/failure.h"
#include "client/cli/client.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/options/values.h"
#include "client/cli/output/breaks_picture.h"
#include "client/cli/output/junit.h"
#include "client/cli/output/scene_json.h"

#define SCHEMA "sheen-breaks-1" /* client/schema/breaks-1.json */
enum { MOST_ROWS = 40, OUT_OF_TOLERANCE = 1 };

/* --- names and units */

static const struct {
    const char *key, *title, *unit;
} MEASURES[SHEEN_N_BREAK_MEASURES] = {
    [SHEEN_BREAK_GAP] = {"gap", "gap", "units"},
    [SHEEN_BREAK_ANGLE] = {"angle_deg", "angle", "degrees"},
    [SHEEN_BREAK_CURVATURE] = {"curvature", "curvature", "1/unit"},
    [SHEEN_BREAK_PERCENT] = {"curvature_percent", "curvature", "%"},
    [SHEEN_BREAK_KINK] = {"kink_deg", "kink", "degrees"},
    [SHEEN_BREAK_JUMP] = {"jump_spacings", "jump", "spacings"},
};

static const char *kind_name(enum sheen_break_kind kind)
{
    static const char *const names[] = {"crease", "semi-sharp", "joint"};
    return (size_t)kind < sizeof(names) / sizeof(*names) ? names[kind] : "other";
}

/* The measures that have a limit. */
static const struct {
    enum sheen_break_measure measure;
    const char *option;
} LIMITED[] = {{SHEEN_BREAK_GAP, "--gap"},
               {SHEEN_BREAK_ANGLE, "--angle"},
               {SHEEN_BREAK_PERCENT, "--curvature"}};
#define N_LIMITED (sizeof(LIMITED) / sizeof(*LIMITED))

static double limit_of(const struct sheen_breaks *breaks, enum sheen_break_measure measure)
{
    return measure == SHEEN_BREAK_GAP     ? breaks->gap
           : measure == SHEEN_BREAK_ANGLE ? breaks->angle_deg
                                          : breaks->curvature_percent;
}

/* Whether the limit is the default, and not the user's. */
static bool is_default(const struct options *options, enum sheen_break_measure measure)
{
    const struct sheen_break_limits *limits = &options->break_limits;
    return (measure == SHEEN_BREAK_GAP     ? limits->gap
            : measure == SHEEN_BREAK_ANGLE ? limits->angle_deg
                                           : limits->curvature_percent) == 0;
}

/* The edge with the largest value of a measure; semi-sharp creases, which are no breaks, are left out. NULL: none. */
static const struct sheen_break_edge *worst_edge(const struct sheen_breaks *breaks,
                                                 enum sheen_break_measure measure)
{
    const struct sheen_break_edge *worst = NULL;
    for (uint32_t i = 0; i < breaks->n_edges; i++) {
        const struct sheen_break_edge *edge = &breaks->edges[i];
        double value = edge->worst[measure].value;
        if (edge->kind != SHEEN_BREAK_SEMISHARP && !isnan(value) &&
            (!worst || value > worst->worst[measure].value))
            worst = edge;
    }
    return worst;
}

/* --- JSON */

static void json_worst(struct json *json, const char *key, const struct sheen_break_worst *worst)
{
    if (isnan(worst->value)) {
        json_double(json, key, worst->value); /* null */
        return;
    }
    json_object_begin(json, key);
    json_double(json, "value", worst->value);
    json_vec3(json, "position", worst->position);
    json_array_begin(json, "uv");
    json_double(json, NULL, worst->uv[0]);
    json_double(json, NULL, worst->uv[1]);
    json_array_end(json);
    json_object_end(json);
}

static void json_pair(struct json *json, const char *key, const uint32_t pair[2])
{
    json_array_begin(json, key);
    json_uint(json, NULL, pair[0]);
    json_uint(json, NULL, pair[1]);
    json_array_end(json);
}

static void json_edge(struct json *json, const struct sheen_break_edge *edge)
{
    json_object_begin(json, NULL);
    json_string(json, "kind", kind_name(edge->kind));
    json_pair(json, "faces", edge->faces);
    json_pair(json, "edges", edge->edges);
    json_bool(json, "dart", edge->has_dart);
    json_double(json, "length", edge->length);
    json_double(json, "out_length", edge->out_length);
    json_array_begin(json, "over");
    for (size_t i = 0; i < N_LIMITED; i++)
        if (edge->over >> LIMITED[i].measure & 1)
            json_string(json, NULL, MEASURES[LIMITED[i].measure].key);
    json_array_end(json);
    for (int i = 0; i < SHEEN_N_BREAK_MEASURES; i++)
        json_worst(json, MEASURES[i].key, &edge->worst[i]);
    json_uint(json, "kink_light", edge->kink_light);
    json_uint(json, "jump_light", edge->jump_light);
    json_double(json, "shift", edge->shift);
    json_object_end(json);
}

static void json_vertex(struct json *json, const struct sheen_break_vertex *vertex)
{
    json_object_begin(json, NULL);
    json_vec3(json, "position", vertex->position);
    json_uint(json, "face", vertex->face);
    json_uint(json, "corner", vertex->corner);
    json_uint(json, "faces", vertex->n_faces);
    json_bool(json, "inside", vertex->is_inside);
    json_double(json, "radius", vertex->radius);
    json_double(json, "k_least", vertex->k_least);
    json_double(json, "k_greatest", vertex->k_greatest);
    json_object_end(json);
}

static void json_limits(struct json *json, const struct options *options,
                        const struct sheen_breaks *breaks)
{
    json_object_begin(json, "limits");
    for (size_t i = 0; i < N_LIMITED; i++) {
        json_object_begin(json, MEASURES[LIMITED[i].measure].key);
        json_double(json, "value", limit_of(breaks, LIMITED[i].measure));
        json_bool(json, "default", is_default(options, LIMITED[i].measure));
        json_object_end(json);
    }
    json_object_end(json);
}

/* The worst edge of each measure, by its place in `edges`. */
static void json_extremes(struct json *json, const struct sheen_breaks *breaks)
{
    json_object_begin(json, "worst");
    for (int i = 0; i < SHEEN_N_BREAK_MEASURES; i++) {
        const struct sheen_break_edge *edge = worst_edge(breaks, (enum sheen_break_measure)i);
        if (!edge) {
            json_double(json, MEASURES[i].key, (double)NAN);
            continue;
        }
        json_object_begin(json, MEASURES[i].key);
        json_double(json, "value", edge->worst[i].value);
        json_uint(json, "edge", (uint64_t)(edge - breaks->edges));
        json_object_end(json);
    }
    json_object_end(json);
}

static void print_json(struct json *json, const struct options *options,
                       const struct client *client, const struct sheen_breaks *breaks)
{
    const struct {
        const char *key;
        uint32_t value;
    } counts[] = {{"edges", breaks->n_edges},      {"out", breaks->n_out},
                  {"creases", breaks->n_creases},  {"semisharp", breaks->n_semisharp},
                  {"joints", breaks->n_joints},    {"borders", breaks->n_borders},
                  {"vertices", breaks->n_vertices}};
    json_object_begin(json, NULL);
    json_string(json, "schema", SCHEMA);
    json_string(json, "model", options->model);
    json_hex(json, "model_sha256", client->model_id, SHEEN_ID_BYTES);
    json_bool(json, "weld", options->weld);
    json_string(json, "server", breaks->server);
    json_uint(json, "total_us", breaks->total_us);
    json_string(json, "unit", "the file's own");
    json_double(json, "diagonal", breaks->diagonal);
    json_bool(json, "within", breaks->n_out == 0);
    json_limits(json, options, breaks);
    json_object_begin(json, "counts");
    for (size_t i = 0; i < sizeof(counts) / sizeof(*counts); i++)
        json_uint(json, counts[i].key, counts[i].value);
    json_object_end(json);
    json_object_begin(json, "lengths");
    json_double(json, "creases", breaks->creases_length);
    json_double(json, "borders", breaks->borders_length);
    json_double(json, "out", breaks->out_length);
    json_object_end(json);
    json_extremes(json, breaks);
    json_array_begin(json, "edges");
    for (uint32_t i = 0; i < breaks->n_edges; i++)
        json_edge(json, &breaks->edges[i]);
    json_array_end(json);
    json_array_begin(json, "vertices");
    for (uint32_t i = 0; i < breaks->n_vertices; i++)
        json_vertex(json, &breaks->vertices[i]);
    json_array_end(json);
    scene_json_lines(json, &breaks->camera, &breaks->lines, breaks->lights, breaks->n_lights);
    json_object_end(json);
}

/* --- the table */

static void print_limits(const struct options *options, const struct sheen_breaks *breaks)
{
    printf("limits: gap %.3g units%s, angle %.3g degrees%s, curvature %.3g %%%s\n", breaks->gap,
           is_default(options, SHEEN_BREAK_GAP)
               ? " (default: 1e-5 of the diagonal of the model's box, because the file does not "
                 "name its unit)"
               : "",
           breaks->angle_deg, is_default(options, SHEEN_BREAK_ANGLE) ? " (default)" : "",
           breaks->curvature_percent, is_default(options, SHEEN_BREAK_PERCENT) ? " (default)" : "");
}

/* A number in 9 columns; a measure without a value is a dash. A measure over its limit is marked. */
static void print_number(double value, bool is_over)
{
    if (isnan(value))
        printf(" %9s ", "-");
    else
        printf(" %9.3g%c", value, is_over ? '!' : ' ');
}

static void print_edge(const struct sheen_break_edge *edge)
{
    /* Where it is: the worst place of what is over its limit, else of the angle. */
    enum sheen_break_measure where = SHEEN_BREAK_ANGLE;
    for (size_t i = 0; i < N_LIMITED; i++)
        if (edge->over >> LIMITED[i].measure & 1)
            where = LIMITED[i].measure;
    const struct sheen_break_worst *worst = &edge->worst[where];
    printf("%-10s %6u %6u %9.3g %9.3g", kind_name(edge->kind), edge->faces[0], edge->faces[1],
           edge->length, edge->out_length);
    for (int i = 0; i < SHEEN_N_BREAK_MEASURES; i++)
        print_number(edge->worst[i].value, edge->over >> i & 1);
    printf(" %.5g,%.5g,%.5g%s\n", worst->position[0], worst->position[1], worst->position[2],
           edge->has_dart ? " dart" : "");
}

static void print_vertices(const struct sheen_breaks *breaks)
{
    const struct sheen_break_vertex *sharpest = NULL;
    double most = 0;
    for (uint32_t i = 0; i < breaks->n_vertices; i++) {
        const struct sheen_break_vertex *vertex = &breaks->vertices[i];
        double spread = vertex->k_greatest - vertex->k_least;
        if (!sharpest || spread > most) {
            sharpest = vertex;
            most = spread;
        }
    }
    if (!sharpest)
        return;
    printf("%u extraordinary %s; the widest range of curvature is %.4g to %.4g 1/unit, %.3g units "
           "away from the one at %.5g,%.5g,%.5g (%u %s)\n",
           breaks->n_vertices, value_noun(breaks->n_vertices, "vertex", "vertices"),
           sharpest->k_least, sharpest->k_greatest, sharpest->radius, sharpest->position[0],
           sharpest->position[1], sharpest->position[2], sharpest->n_faces,
           value_noun(sharpest->n_faces, "face", "faces"));
}

static void print_table(const struct options *options, const struct sheen_breaks *breaks)
{
    printf("%u %s: %u %s, %u semi-sharp, %u %s, on %.4g units; %u %s on %.4g units\n",
           breaks->n_edges, value_noun(breaks->n_edges, "edge", "edges"), breaks->n_creases,
           value_noun(breaks->n_creases, "crease", "creases"), breaks->n_semisharp,
           breaks->n_joints, value_noun(breaks->n_joints, "joint", "joints"),
           breaks->creases_length, breaks->n_borders,
           value_noun(breaks->n_borders, "border", "borders"), breaks->borders_length);
    print_limits(options, breaks);
    printf("%u out of tolerance, on %.4g units\n", breaks->n_out, breaks->out_length);
    const uint32_t n_rows = breaks->n_edges - breaks->n_semisharp;
    if (n_rows > 0)
        printf("%-10s %6s %6s %9s %9s %9s  %9s  %9s  %9s  %9s  %9s  %s\n"
               "%-10s %6s %6s %9s %9s %9s  %9s  %9s  %9s  %9s  %9s  %s\n",
               "kind", "face", "face", "length", "out", "gap", "angle", "curvature", "curvature",
               "kink", "jump", "where", "", "", "", "units", "units", "units", "degrees", "1/unit",
               "%", "degrees", "spacings", "");
    uint32_t n = 0;
    for (uint32_t i = 0; i < breaks->n_edges && n < MOST_ROWS; i++)
        if (breaks->edges[i].kind != SHEEN_BREAK_SEMISHARP) {
            print_edge(&breaks->edges[i]);
            n++;
        }
    if (n < n_rows)
        printf("... and %u more, which --json lists\n", n_rows - n);
    if (breaks->n_semisharp > 0)
        printf("semi-sharp creases are smooth; --json lists how far they turn\n");
    print_vertices(breaks);
}

/* --- JUnit */

/* Says which edges exceed one limit: their number in `failure`, each of them in `details`, malloc'd. False when memory
 * is short; NULL: none exceeds it. */
static bool describe(const struct sheen_breaks *breaks, enum sheen_break_measure measure,
                     char failure[static 240], char **details)
{
    size_t n_bytes;
    uint32_t n = 0;
    *details = NULL;
    for (uint32_t i = 0; i < breaks->n_edges; i++)
        n += breaks->edges[i].over >> measure & 1;
    if (n == 0)
        return true;
    const struct sheen_break_worst *worst = &worst_edge(breaks, measure)->worst[measure];
    snprintf(failure, 240, "%u %s over the limit of %.6g %s; the worst is %.6g at %.9g,%.9g,%.9g",
             n, value_noun(n, "edge is", "edges are"), limit_of(breaks, measure),
             MEASURES[measure].unit, worst->value, worst->position[0], worst->position[1],
             worst->position[2]);
    FILE *out = open_memstream(details, &n_bytes);
    if (!out)
        return false;
    for (uint32_t i = 0; i < breaks->n_edges; i++) {
        const struct sheen_break_edge *edge = &breaks->edges[i];
        const struct sheen_break_worst *at = &edge->worst[measure];
        if (edge->over >> measure & 1)
            fprintf(out,
                    "%s of faces %u and %u: %.6g %s at %.9g,%.9g,%.9g, %.6g of %.6g units out\n",
                    kind_name(edge->kind), edge->faces[0], edge->faces[1], at->value,
                    MEASURES[measure].unit, at->position[0], at->position[1], at->position[2],
                    edge->out_length, edge->length);
    }
    return fclose(out) == 0;
}

static enum sheen_status write_junit(struct client *client, const struct options *options,
                                     const struct sheen_breaks *breaks)
{
    struct junit_case cases[N_LIMITED];
    char failures[N_LIMITED][240], *details[N_LIMITED] = {NULL};
    bool ok = true;
    for (size_t i = 0; i < N_LIMITED; i++) {
        ok = ok && describe(breaks, LIMITED[i].measure, failures[i], &details[i]);
        cases[i] = (struct junit_case){.name = MEASURES[LIMITED[i].measure].title,
                                       .failure = details[i] ? failures[i] : NULL,
                                       .details = details[i]};
    }
    char name[400];
    snprintf(name, sizeof(name), "sheen breaks %s", options->model);
    const struct junit_suite suite = {name, cases, N_LIMITED, (double)breaks->total_us / 1e6};
    size_t n_bytes = 0;
    char *text = ok ? junit_write(&suite, 1, (int64_t)time(NULL), &n_bytes) : NULL;
    enum sheen_status status =
        text ? file_write(options->junit, (const uint8_t *)text, n_bytes, &client->error)
             : failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for the report");
    free(text);
    for (size_t i = 0; i < N_LIMITED; i++)
        free(details[i]);
    return status;
}

/* --- the picture */

static enum sheen_status write_picture(struct client *client, const struct options *options,
                                       const struct sheen_breaks *breaks)
{
    struct sheen_request request = options->request;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct canvas canvas = {.width_px = 0};
    request.format = SHEEN_FORMAT_ZSTD;
    request.planes = BREAKS_PICTURE_PLANES;
    enum sheen_status status = client_render(client, options, &request, &frame);
    if (!status && !breaks_picture(&canvas, &frame, breaks))
        status = failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for the picture");
    if (!status)
        status = canvas_write_png(&canvas, options->output, &client->error);
    canvas_finish(&canvas);
    sheen_frame_finish(&frame);
    return status;
}

/* --- the command */

static enum sheen_status ask(struct client *client, const struct options *options,
                             struct sheen_breaks *breaks)
{
    struct sheen_request request = options->request;
    enum sheen_status status;
    do {
        memcpy(request.model_id, client->model_id, SHEEN_ID_BYTES);
        status = sheen_find_breaks(client->session, &request, &options->break_limits,
                                   &client->report, breaks, &client->error);
    } while (status && client_resume(client, options, &status));
    if (status == SHEEN_LATE && request.deadline_ms)
        failure_set(&client->error, status,
                    "the breaks were not found within --deadline %u (milliseconds): give it more "
                    "time, or ask again when the daemon has less to do",
                    request.deadline_ms);
    return status;
}

static enum sheen_status print(struct client *client, const struct options *options,
                               const struct sheen_breaks *breaks)
{
    enum sheen_status status = SHEEN_OK;
    if (options->junit)
        status = write_junit(client, options, breaks);
    if (!status && options->output)
        status = write_picture(client, options, breaks);
    progress_clear(&client->progress);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, options, client, breaks);
        status = client_finish_json(client, &json);
    } else if (!status) {
        print_table(options, breaks);
    }
    return status;
}

static int run(const struct options *options)
{
    struct client client = {.session = NULL};
    struct sheen_breaks breaks = SHEEN_BREAKS_DEFAULTS;
    enum sheen_status status =
        options->junit ? file_check_writable(options->junit, &client.error) : SHEEN_OK;
    if (!status && options->output)
        status = file_check_writable(options->output, &client.error);
    if (status)
        return client_finish(&client, status);
    status = client_init(&client, options);
    if (!status)
        status = ask(&client, options, &breaks);
    if (!status)
        status = print(&client, options, &breaks);
    bool is_out = !status && breaks.n_out > 0;
    sheen_breaks_finish(&breaks);
    int code = client_finish(&client, status);
    return is_out ? OUT_OF_TOLERANCE : code;
}

static bool apply_angle(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_ANGLE], value, &options->break_limits.angle_deg, why);
}

static bool apply_gap(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_GAP], value, &options->break_limits.gap, why);
}

static bool apply_curvature(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_PERCENT], value, &options->break_limits.curvature_percent,
                          why);
}

static bool apply_output(struct options *options, const char *value, char *why)
{
    enum sheen_format format;
    options->output = value;
    return (value_format(value, &format) && format == SHEEN_FORMAT_PNG) ||
           options_refuse(why, "must end in .png");
}

static bool apply_junit(struct options *options, const char *value, char *why)
{
    options->junit = value;
    return *value || options_refuse(why, "must be a file");
}

static bool apply_deadline(struct options *options, const char *value, char *why)
{
    return options_whole(&RANGES[RANGE_DEADLINE], value, &options->request.deadline_ms, why);
}

static const struct option_row ROWS[] = {
    {"angle", 0, "DEG",
     "largest angle between the normals of both sides of an edge,\n"
     "{} (default: 0.1)",
     apply_angle, NULL},
    {"gap", 0, "LENGTH",
     "largest distance of both sides of an edge, {}\n"
     "of the model (default: 1e-5 of the diagonal of the model's box). Border edges\n"
     "that lie within 10 times this distance count as joined",
     apply_gap, NULL},
    {"curvature", 0, "PERCENT",
     "largest jump of the curvature across an edge, {},\n"
     "of the mean of both sides (default: 10)",
     apply_curvature, NULL},
    {"output", 'o', "FILE",
     "write a picture of the lines (.png) with the edges out of tolerance painted:\n"
     "magenta, a gap; red, an angle; orange, the curvature",
     apply_output, NULL},
    {"junit", 0, "FILE", "write a JUnit report, with a test case for each limit", apply_junit,
     NULL},
    {"deadline", 0, "MS", "give up after this time, {}\n(default: none)", apply_deadline, NULL},
    {0},
};

static const struct option_row *const TABLES[] = {
    ROWS,           OPTIONS_SIZE,      OPTIONS_SCENE,  OPTIONS_MODEL,
    OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_BREAKS = {
    .name = "breaks",
    .arguments = "MODEL [option]...",
    .summary =
        "Finds where the lines of a surface break, along creases and joints, and by how much:\n"
        "gap, angle, jump of the curvature, kink and jump of the lines, at the worst place of\n"
        "each edge, the worst edge first. Camera, lights and lines decide kinks and jumps alone.",
    .tables = TABLES,
    .examples =
        "  sheen breaks hood.obj\n"
        "  sheen breaks hood.obj --angle 0.05 --gap 0.01 --curvature 5\n"
        "  sheen breaks hood.obj -o breaks.png --view front\n"
        "  sheen breaks hood.obj --json --junit breaks.xml > breaks.json\n"
        "  sheen breaks hood.obj --lines highlight --light plane --pattern stripes:period=5\n",
    .takes_model = true,
    .check = options_check_scene,
    .codes = CODE_FILES | CODE_SERVER | CODE_LATE,
    .no = "an edge is out of tolerance",
    .run = run,
};
