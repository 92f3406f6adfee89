/* sheen_compare(). */
#include <math.h>
#include <string.h>

#include "client/lib/numbers/compute.h"
#include "client/lib/scene_convert.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"
#include "protocol/messages/message_values.h"

static struct sheen_compared_place place_of(const sheen_ComparedPlace *from)
{
    struct sheen_compared_place to = {.face = from->face, .uv = {from->u, from->v}};
    message_read_vec3(&from->position, to.position);
    return to;
}

static struct sheen_compared_measure measure_of(bool is_known, const sheen_ComparedMeasure *from)
{
    if (!is_known)
        return (struct sheen_compared_measure){.is_known = false};
    return (struct sheen_compared_measure){
        .is_known = true,
        .worst = from->worst,
        .at = {place_of(&from->old), place_of(&from->new)},
        .rms = from->rms,
        .p95 = from->p95,
        .p99 = from->p99,
        .area_out = from->area_out,
    };
}

static struct sheen_compared_side side_of(const sheen_ComparedSide *from)
{
    return (struct sheen_compared_side){
        .samples = from->samples,
        .area = from->area,
        .area_uncovered = from->area_uncovered,
        .area_rewound = from->area_rewound,
        .area_unlit = from->area_unlit,
        .has_uncovered = from->has_uncovered,
        .uncovered = place_of(&from->uncovered),
        .measures = {
            [SHEEN_COMPARE_DISTANCE] = measure_of(from->has_distance, &from->distance),
            [SHEEN_COMPARE_NORMAL] = measure_of(from->has_normal_deg, &from->normal_deg),
            [SHEEN_COMPARE_LINES] = measure_of(from->has_lines, &from->lines),
            [SHEEN_COMPARE_LINE_LENGTH] = measure_of(from->has_line_length, &from->line_length),
            [SHEEN_COMPARE_CURVATURE] = measure_of(from->has_curvature, &from->curvature),
        }};
}

static void fill_alignment(struct sheen_comparison *to, const sheen_Alignment *from)
{
    to->is_aligned = true;
    message_read_vec3(&from->x, to->rotation);
    message_read_vec3(&from->y, to->rotation + 3);
    message_read_vec3(&from->z, to->rotation + 6);
    message_read_vec3(&from->shift, to->shift);
    to->rotation_deg = from->rotation_deg;
    to->rms_before = from->rms_before;
    to->rms_after = from->rms_after;
    to->free_directions = from->free;
}

static void fill(struct sheen_comparison *to, const sheen_Compared *from)
{
    *to = (struct sheen_comparison){
        .sides = {side_of(&from->old), side_of(&from->new)},
        .is_rewound = from->rewound,
        .diagonal = from->diagonal,
        .distance_floor = from->distance_floor,
        .normal_floor_deg = from->normal_floor_deg,
        .limits = {from->distance, from->normal_deg, from->lines,
                   from->has_line_length ? from->line_length : (double)INFINITY,
                   from->has_curvature ? from->curvature : (double)INFINITY},
        .n_lights = from->lights_count,
        .total_us = from->total_us,
    };
    if (from->has_alignment)
        fill_alignment(to, &from->alignment);
    scene_camera_from_message(&to->camera, &from->camera);
    scene_lines_from_message(&to->lines, &from->lines_used);
    for (uint32_t i = 0; i < to->n_lights; i++)
        scene_light_from_message(&to->lights[i], &from->lights[i]);
    memcpy(to->server, from->server, sizeof(to->server));
}

static void put_options(sheen_Compare *asked, const struct sheen_compare_options *options)
{
    const double *limits = options->limits;
    memcpy(asked->new_sha256, options->new_id, SHEEN_ID_BYTES);
    asked->has_distance = limits[SHEEN_COMPARE_DISTANCE] != 0;
    asked->distance = limits[SHEEN_COMPARE_DISTANCE];
    asked->has_normal_deg = limits[SHEEN_COMPARE_NORMAL] != 0;
    asked->normal_deg = limits[SHEEN_COMPARE_NORMAL];
    asked->has_lines = limits[SHEEN_COMPARE_LINES] != 0;
    asked->lines = limits[SHEEN_COMPARE_LINES];
    asked->has_line_length = limits[SHEEN_COMPARE_LINE_LENGTH] != 0;
    asked->line_length = limits[SHEEN_COMPARE_LINE_LENGTH];
    asked->has_curvature = limits[SHEEN_COMPARE_CURVATURE] != 0;
    asked->curvature = limits[SHEEN_COMPARE_CURVATURE];
    asked->has_align = asked->align = options->align;
    asked->has_samples = options->samples != 0;
    asked->samples = options->samples;
}

enum sheen_status sheen_compare(struct sheen_session *session, const struct sheen_request *request,
                                const struct sheen_compare_options *options,
                                const struct sheen_progress *progress,
                                struct sheen_comparison *comparison, struct sheen_error *error)
{
    char text[MESSAGE_TEXT_BYTES];
    struct sheen_compare_options whole = SHEEN_COMPARE_OPTIONS_DEFAULTS;
    sheen_Compare asked = sheen_Compare_init_zero;
    sheen_Compared answer;
    const uint64_t no_data = 0;
    uint8_t *data;
    enum sheen_status status = sized_check(comparison, "comparison", error);
    if (!status)
        status = sized_take(&whole, sizeof(whole), options, "options", error);
    if (!status)
        status = compute_scene(session, request, "compare surfaces", &asked.scene, error);
    if (status)
        return status;
    put_options(&asked, &whole);
    if (!message_check_compare(&asked, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    status = compute_run(session, MESSAGE_COMPARE, &asked, MESSAGE_COMPARED, &answer, &no_data,
                         progress, &data, error);
    if (status)
        return status;
    struct sheen_comparison result;
    fill(&result, &answer);
    sized_give(comparison, &result, sizeof(result));
    return SHEEN_OK;
}
