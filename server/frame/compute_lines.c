/* TRACE_LINES: lines on the surface as curves. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "protocol/curve_records.h"
#include "server/base/clock.h"
#include "server/curves/lines/surface_lines.h"
#include "server/frame/compute.h"
#include "server/scene/scene_convert.h"

static const sheen_Render *scene_of(const union compute_asked *asked)
{
    return &asked->trace_lines.scene;
}

static double diagonal_of(const struct limit_tables *tables)
{
    double diagonal = 0;
    for (int i = 0; i < 3; i++)
        diagonal = hypot(diagonal, tables->box_max[i] - tables->box_min[i]);
    return diagonal;
}

/* Of the diagonal. The points of tables are rounded to more than that. */
static const double LEAST_TOLERANCE = 1e-9;

static double tolerance_of(const struct compute *compute)
{
    const sheen_TraceLines *asked = &compute->asked.trace_lines;
    const double tolerance = 1e-5 * diagonal_of(compute->tables[0]);
    return asked->has_tolerance ? asked->tolerance
           : tolerance > 0      ? tolerance
                                : 1; /* a model of one point */
}

/* How many curves a surface has is not known in advance. A surface of n faces gets so much memory for them; curves that
 * need more are refused. A fifth of it is for the records of the answer. A car of 1,575 faces fits with the default
 * light and tolerance; a large surface gets no more than MOST_BYTES, because it is seldom seen in as much detail. */
enum { BYTES_OF_MODEL = 32 << 20, BYTES_OF_FACE = 256 << 10, MOST_BYTES = 512 << 20 };

static uint64_t bytes_of(const struct compute *compute)
{
    const uint64_t bytes = BYTES_OF_MODEL + (uint64_t)BYTES_OF_FACE * compute->tables[0]->n_faces;
    return bytes < MOST_BYTES ? bytes : MOST_BYTES;
}

/* --- which lines */

static bool set_is_full(struct error *error)
{
    return error_set(error, ERROR_REQUEST,
                     "more than %d lines: give fewer places by --at, or a pattern with fewer",
                     LINE_SET_MOST_LINES);
}

/* Adds the line at one place of a light. */
static bool add_place(struct line_set *set, const struct line_map *map, uint32_t light,
                      double place, struct error *error)
{
    switch (line_set_add(set, map, (uint16_t)light, place)) {
    case LINE_ADDED:
    case LINE_NOT_THERE:
        return true;
    case LINE_SET_FULL:
        return set_is_full(error);
    case LINE_NO_CURVE:
        break;
    }
    return error_set(error, ERROR_REQUEST,
                     "pattern.rotation_deg of light %u: on a closed light and at infinity, curves "
                     "are traced of patterns that are turned by a multiple of 90 degrees, and for "
                     "isophotes of 180",
                     light + 1);
}

/* Adds the middle of each bright stripe (shaders/README.md, "Patterns"). */
static bool add_stripes(struct line_set *set, const struct line_map *map, uint32_t light,
                        struct error *error)
{
    const struct pattern *pattern = &map->pattern;
    double count = pattern->period > 0 ? map->width / pattern->period : pattern->count;
    double shift = pattern->duty / 2 - pattern->offset;
    double first = ceil(-shift), last = floor(count - shift);
    if (!(last - first < LINE_SET_MOST_LINES))
        return set_is_full(error);
    for (double k = first; k <= last; k++)
        if (!add_place(set, map, light, (k + shift) / count, error))
            return false;
    return true;
}

static bool add_light(struct line_set *set, const struct line_map *map, uint32_t light,
                      const sheen_TraceLines *asked, struct error *error)
{
    const struct pattern *pattern = &map->pattern;
    bool is_asked = asked->at_count > 0;
    const double *at = is_asked ? asked->at : pattern->at;
    size_t n = is_asked ? asked->at_count : pattern->kind == PATTERN_LINES ? pattern->n_at : 0;
    for (size_t i = 0; i < n; i++)
        if (!add_place(set, map, light, at[i], error))
            return false;
    if (n > 0)
        return true;
    if (pattern->kind == PATTERN_STRIPES || pattern->kind == PATTERN_LATTICE)
        return add_stripes(set, map, light, error);
    return error_set(error, ERROR_REQUEST,
                     "light %u: only stripes, lattices and lines have places of lines; give others "
                     "by --at",
                     light + 1);
}

static bool make_set(const struct compute *compute, struct line_set *set, struct error *error)
{
    const struct frame_request *scene = &compute->scene;
    const sheen_TraceLines *asked = &compute->asked.trace_lines;
    struct line_map map;
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        line_map_init(&map, &scene->lines, &scene->lights[i]);
        if (asked->silhouettes)
            return line_set_add_silhouette(set, &map) == LINE_ADDED;
        if (!add_light(set, &map, i, asked, error))
            return false;
    }
    return true;
}

static struct computation *create(const struct compute *compute, struct error *error)
{
    if (tolerance_of(compute) < LEAST_TOLERANCE * diagonal_of(compute->tables[0])) {
        error_set(
            error, ERROR_REQUEST,
            "tolerance (--tolerance) is %.9g; of this model it must be at least %.3g, 1e-9 of "
            "the diagonal of its box",
            tolerance_of(compute), LEAST_TOLERANCE * diagonal_of(compute->tables[0]));
        return NULL;
    }
    struct line_set *set = calloc(1, sizeof *set);
    struct surface_lines *lines = NULL;
    if (!set)
        error_set(error, ERROR_SERVER, "no memory for lines: try again later");
    else if (make_set(compute, set, error))
        lines = surface_lines_create(compute->tables[0], set, tolerance_of(compute),
                                     (size_t)(compute->bytes / 5 * 4), error);
    free(set);
    return lines ? surface_lines_computation(lines) : NULL;
}

/* --- the answer */

static void put(struct vec v, double out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

/* Newton's method may leave a patch by the last digit. */
static double parameter(double value)
{
    return fmin(fmax(value, 0), 1);
}

static uint8_t *pack_curve(const struct surface_lines_result *result, const struct curve *curve,
                           uint8_t *to)
{
    const struct line_set *set = result->set;
    bool is_silhouette = line_set_field(set, curve->line)->form == FIELD_SILHOUETTE;
    const struct curve_record record = {
        .kind = is_silhouette ? CURVE_SILHOUETTE : CURVE_LINE,
        .is_closed = curve->closed,
        .light = set->light[curve->line],
        .line = curve->line,
        .place = is_silhouette ? (double)NAN : set->line[curve->line].place,
        .points = curve->n,
        .length = result->curves->length[curve->first + curve->n - 1],
    };
    curve_pack(&record, to);
    return to + CURVE_BYTES;
}

static uint8_t *pack_points(const struct curve_set *curves, const struct curve *curve, uint8_t *to)
{
    for (size_t k = curve->first; k < curve->first + curve->n; k++, to += CURVE_POINT_BYTES) {
        const struct traced_point *point = &curves->point[k];
        struct curve_point_record record = {
            .face = point->face,
            .u = parameter(point->u),
            .v = parameter(point->v),
            .residual = point->residual,
            .length = curves->length[k],
        };
        put(point->p, record.point);
        put(point->n, record.normal);
        put(point->along, record.along);
        curve_point_pack(&record, to);
    }
    return to;
}

static uint8_t *pack_mark(const struct line_set *set, const struct traced_mark *mark, uint8_t *to)
{
    struct curve_mark_record record = {
        .kind = mark->kind == MARK_FLAT ? CURVE_FLAT : CURVE_SINGULAR,
        .light = set->light[mark->line],
        .line = mark->line,
        .face = mark->at.face,
        .u = parameter(mark->at.u),
        .v = parameter(mark->at.v),
    };
    put(mark->at.p, record.point);
    put(mark->at.n, record.normal);
    curve_mark_pack(&record, to);
    return to + CURVE_MARK_BYTES;
}

static bool pack_records(struct compute *compute, const struct surface_lines_result *result,
                         struct error *error)
{
    const struct curve_set *curves = result->curves;
    uint64_t bytes = (uint64_t)curves->n_curves * CURVE_BYTES +
                     (uint64_t)curves->n_points * CURVE_POINT_BYTES +
                     (uint64_t)result->n_marks * CURVE_MARK_BYTES;
    if (bytes > compute->bytes / 5 || bytes > PROTOCOL_MAX_FRAME_BYTES)
        return error_set(error, ERROR_REQUEST,
                         "the curves have %zu points, more than this model may have: give a larger "
                         "tolerance or fewer lines",
                         curves->n_points);
    compute->records_bytes = (size_t)bytes;
    if (bytes == 0)
        return true;
    compute->records = block_cache_take(compute->request->host->block_cache, (size_t)bytes);
    if (!compute->records)
        return error_set(error, ERROR_SERVER, "no memory for the curves: try again later");
    uint8_t *to = compute->records;
    for (size_t i = 0; i < curves->n_curves; i++)
        to = pack_curve(result, &curves->curve[i], to);
    for (size_t i = 0; i < curves->n_curves; i++)
        to = pack_points(curves, &curves->curve[i], to);
    for (size_t i = 0; i < result->n_marks; i++)
        to = pack_mark(result->set, &result->marks[i], to);
    return true;
}

static bool pack(struct compute *compute, struct error *error)
{
    const struct surface_lines_result result =
        surface_lines_get((const struct surface_lines *)compute->computation);
    const struct frame_request *scene = &compute->scene;
    const sheen_Render *asked = &compute->request->render;
    if (!pack_records(compute, &result, error))
        return false;
    sheen_Curves *answer = &compute->answer.curves;
    *answer = (sheen_Curves){
        .data_bytes = compute->records_bytes,
        .curves = (uint32_t)result.curves->n_curves,
        .points = result.curves->n_points,
        .marks = (uint32_t)result.n_marks,
        .tolerance = tolerance_of(compute),
        .diagonal = diagonal_of(compute->tables[0]),
        .total_us = clock_now_us() - compute->request->start_us,
        .camera = scene_write_camera(&scene->camera),
        .lines = scene_write_lines(&scene->lines),
        .lights_count = (pb_size_t)scene->n_lights,
    };
    for (uint32_t i = 0; i < scene->n_lights; i++)
        answer->lights[i] = scene_write_light(&scene->lights[i],
                                              i < asked->lights_count ? &asked->lights[i] : NULL);
    snprintf(answer->server, sizeof answer->server, "%s", SHEEN_VERSION);
    return true;
}

const struct compute_kind compute_lines_kind = {
    .answer = MESSAGE_CURVES,
    .what = "tracing lines",
    .scene = scene_of,
    .bytes = bytes_of,
    .create = create,
    .pack = pack,
};
