/* COMPARE: how far two surfaces differ. */
#include <math.h>
#include <stdio.h>

#include "server/base/clock.h"
#include "server/curves/compare/comparison.h"
#include "server/frame/compute.h"
#include "server/scene/scene_convert.h"

static const sheen_Render *scene_of(const union compute_asked *asked)
{
    return &asked->compare.scene;
}

static const uint8_t *second_of(const union compute_asked *asked)
{
    return asked->compare.new_sha256;
}

/* The limit of the distance that is asked for, or its default. */
static double distance_limit(const struct compute *compute)
{
    const sheen_Compare *asked = &compute->asked.compare;
    const struct limit_tables *old = compute->tables[0];
    double diagonal = 0;
    for (int i = 0; i < 3; i++)
        diagonal = hypot(diagonal, old->box_max[i] - old->box_min[i]);
    return asked->has_distance ? asked->distance
           : diagonal > 0      ? 1e-5 * diagonal
                               : 1; /* a model of one point */
}

static uint64_t bytes_of(const struct compute *compute)
{
    return comparison_bytes(compute->tables, compute->asked.compare.samples);
}

static struct computation *create(const struct compute *compute, struct error *error)
{
    const sheen_Compare *asked = &compute->asked.compare;
    const struct frame_request *scene = &compute->scene;
    struct comparison_setup setup = {
        .tables = {compute->tables[0], compute->tables[1]},
        .n_lights = scene->n_lights,
        .has_curvature = asked->has_curvature,
        .is_aligned = asked->align,
        .limit = {[COMPARISON_DISTANCE] = distance_limit(compute),
                  [COMPARISON_NORMAL] = asked->normal_deg,
                  [COMPARISON_LINES] = asked->lines,
                  [COMPARISON_LINE_LENGTH] = asked->has_line_length ? asked->line_length : INFINITY,
                  [COMPARISON_CURVATURE] = asked->has_curvature ? asked->curvature : INFINITY},
        .n_samples = asked->samples,
        .most_bytes = compute->bytes,
    };
    for (uint32_t i = 0; i < scene->n_lights; i++)
        line_map_init(&setup.lights[i], &scene->lines, &scene->lights[i]);
    return comparison_create(&setup, error);
}

static sheen_Vec3 vec3_of(struct vec v)
{
    return (sheen_Vec3){v.x, v.y, v.z};
}

static sheen_ComparedPlace place_of(const struct comparison_place *place)
{
    return (sheen_ComparedPlace){place->face, place->u, place->v, vec3_of(place->position)};
}

static bool put_measure(const struct comparison_figures *figures, sheen_ComparedMeasure *to)
{
    if (figures->is_known)
        *to = (sheen_ComparedMeasure){
            .worst = figures->worst,
            .old = place_of(&figures->at[COMPARISON_OLD]),
            .new = place_of(&figures->at[COMPARISON_NEW]),
            .rms = figures->rms,
            .p95 = figures->p95,
            .p99 = figures->p99,
            .area_out = figures->area_out,
        };
    return figures->is_known;
}

static void put_side(const struct comparison_result_side *side, sheen_ComparedSide *to)
{
    const struct comparison_figures *figures = side->figures;
    *to = (sheen_ComparedSide){
        .samples = side->n_samples,
        .area = side->area,
        .area_uncovered = side->area_uncovered,
        .area_rewound = side->area_rewound,
        .area_unlit = side->area_unlit,
        .has_uncovered = side->area_uncovered > 0,
        .uncovered = place_of(&side->uncovered_at),
    };
    to->has_distance = put_measure(&figures[COMPARISON_DISTANCE], &to->distance);
    to->has_normal_deg = put_measure(&figures[COMPARISON_NORMAL], &to->normal_deg);
    to->has_lines = put_measure(&figures[COMPARISON_LINES], &to->lines);
    to->has_line_length = put_measure(&figures[COMPARISON_LINE_LENGTH], &to->line_length);
    to->has_curvature = put_measure(&figures[COMPARISON_CURVATURE], &to->curvature);
}

static sheen_Alignment alignment_of(const struct comparison_result *result)
{
    const struct rigid_motion *motion = &result->motion;
    return (sheen_Alignment){
        .x = vec3_of(motion->row[0]),
        .y = vec3_of(motion->row[1]),
        .z = vec3_of(motion->row[2]),
        .shift = vec3_of(motion->shift),
        .rotation_deg = result->rotation_deg,
        .rms_before = fmax(result->rms_before, 0), /* negative: no pair was found */
        .rms_after = result->rms_after,
        .has_free = true,
        .free = result->free_directions,
    };
}

static bool pack(struct compute *compute, struct error *error)
{
    (void)error;
    const struct comparison_result *result = comparison_read(compute->computation);
    const struct frame_request *scene = &compute->scene;
    const sheen_Compare *asked = &compute->asked.compare;
    sheen_Compared *answer = &compute->answer.compared;
    *answer = (sheen_Compared){
        .rewound = result->is_rewound,
        .diagonal = result->size,
        .distance_floor = result->distance_floor,
        .normal_floor_deg = result->normal_floor_deg,
        .distance = distance_limit(compute),
        .normal_deg = asked->normal_deg,
        .lines = asked->lines,
        .has_line_length = asked->has_line_length,
        .line_length = asked->line_length,
        .has_curvature = asked->has_curvature,
        .curvature = asked->curvature,
        .has_alignment = asked->align,
        .total_us = clock_now_us() - compute->request->start_us,
        .camera = scene_write_camera(&scene->camera),
        .lights_count = (pb_size_t)scene->n_lights,
        .lines_used = scene_write_lines(&scene->lines),
    };
    put_side(&result->side[COMPARISON_OLD], &answer->old);
    put_side(&result->side[COMPARISON_NEW], &answer->new);
    if (asked->align)
        answer->alignment = alignment_of(result);
    for (uint32_t i = 0; i < scene->n_lights; i++)
        answer->lights[i] = scene_write_light(
            &scene->lights[i], i < asked->scene.lights_count ? &asked->scene.lights[i] : NULL);
    snprintf(answer->server, sizeof answer->server, "%s", SHEEN_VERSION);
    return true;
}

const struct compute_kind compute_compare_kind = {
    .answer = MESSAGE_COMPARED,
    .what = "comparing surfaces",
    .scene = scene_of,
    .second = second_of,
    .bytes = bytes_of,
    .create = create,
    .pack = pack,
};
