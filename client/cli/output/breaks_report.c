#include "client/cli/output/breaks_report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "client/cli/options/values.h"
#include "client/cli/output/junit.h"
#include "client/cli/output/scene_json.h"

#define SCHEMA "sheen-breaks-1" /* client/schema/breaks-1.json */
enum { MOST_ROWS = 40 };
/* Vertices around which the surface turns by less than this many radians are flat, but for rounding. */
static const double FLAT_TURN = 1e-6;

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
    json_text(json, "kind", kind_name(edge->kind));
    json_pair(json, "faces", edge->faces);
    json_pair(json, "edges", edge->edges);
    json_bool(json, "dart", edge->has_dart);
    json_double(json, "length", edge->length);
    json_double(json, "out_length", edge->out_length);
    json_array_begin(json, "over");
    for (size_t i = 0; i < N_LIMITED; i++)
        if (edge->over >> LIMITED[i].measure & 1)
            json_text(json, NULL, MEASURES[LIMITED[i].measure].key);
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

void breaks_json(struct json *json, const struct options *options,
                 const uint8_t model_id[SHEEN_ID_BYTES], const struct sheen_breaks *breaks)
{
    const struct {
        const char *key;
        uint32_t value;
    } counts[] = {{"edges", breaks->n_edges},      {"out", breaks->n_out},
                  {"creases", breaks->n_creases},  {"semisharp", breaks->n_semisharp},
                  {"joints", breaks->n_joints},    {"borders", breaks->n_borders},
                  {"vertices", breaks->n_vertices}};
    json_object_begin(json, NULL);
    json_text(json, "schema", SCHEMA);
    json_text(json, "model", options->model);
    json_hex(json, "model_sha256", model_id, SHEEN_ID_BYTES);
    json_bool(json, "weld", options->weld);
    json_text(json, "server", breaks->server);
    json_uint(json, "total_us", breaks->total_us);
    json_text(json, "unit", "the file's own");
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
    double most = 0, turn = 0; /* radians, within the radius */
    for (uint32_t i = 0; i < breaks->n_vertices; i++) {
        const struct sheen_break_vertex *vertex = &breaks->vertices[i];
        double spread = vertex->k_greatest - vertex->k_least;
        turn = fmax(turn, fmax(fabs(vertex->k_greatest), fabs(vertex->k_least)) * vertex->radius);
        if (!sharpest || spread > most) {
            sharpest = vertex;
            most = spread;
        }
    }
    if (!sharpest || turn < FLAT_TURN)
        return;
    printf("%u extraordinary %s; the widest range of curvature is %.4g to %.4g 1/unit, %.3g units "
           "away from the one at %.5g,%.5g,%.5g (%u %s)\n",
           breaks->n_vertices, value_noun(breaks->n_vertices, "vertex", "vertices"),
           sharpest->k_least, sharpest->k_greatest, sharpest->radius, sharpest->position[0],
           sharpest->position[1], sharpest->position[2], sharpest->n_faces,
           value_noun(sharpest->n_faces, "face", "faces"));
}

void breaks_table(const struct options *options, const struct sheen_breaks *breaks)
{
    double length = 0;
    for (uint32_t i = 0; i < breaks->n_edges; i++)
        length += breaks->edges[i].length;
    printf("%u %s: %u %s, %u semi-sharp, %u %s, on %.4g units; %u %s on %.4g units\n",
           breaks->n_edges, value_noun(breaks->n_edges, "edge", "edges"), breaks->n_creases,
           value_noun(breaks->n_creases, "crease", "creases"), breaks->n_semisharp,
           breaks->n_joints, value_noun(breaks->n_joints, "joint", "joints"), length,
           breaks->n_borders, value_noun(breaks->n_borders, "border", "borders"),
           breaks->borders_length);
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

char *breaks_junit(const struct options *options, const struct sheen_breaks *breaks,
                   size_t *n_bytes)
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
    char *text = ok ? junit_write(&suite, 1, (int64_t)time(NULL), n_bytes) : NULL;
    for (size_t i = 0; i < N_LIMITED; i++)
        free(details[i]);
    return text;
}
