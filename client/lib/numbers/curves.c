/* sheen_trace_lines(). */
#include <stdlib.h>
#include <string.h>

#include "client/lib/numbers/compute.h"
#include "client/lib/scene_convert.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"
#include "protocol/curve_records.h"

/* The memory that a result owns. */
struct sheen_curves_memory {
    struct sheen_curve *curves;
    struct sheen_curve_point *points;
    struct sheen_curve_mark *marks;
};

_Static_assert((int)SHEEN_CURVE_SINGULAR == (int)CURVE_SINGULAR &&
                   (int)SHEEN_CURVE_FLAT == (int)CURVE_FLAT,
               "kinds have the same numbers on the wire");

static void fill_point(struct sheen_curve_point *to, const struct curve_point_record *from)
{
    *to = (struct sheen_curve_point){
        .face = from->face,
        .uv = {from->u, from->v},
        .residual = from->residual,
        .length = from->length,
    };
    memcpy(to->position, from->point, sizeof(to->position));
    memcpy(to->normal, from->normal, sizeof(to->normal));
    memcpy(to->along, from->along, sizeof(to->along));
}

static bool fill_curves(struct sheen_curves *curves, const uint8_t *bytes)
{
    struct sheen_curves_memory *memory = curves->memory;
    struct curve_record record;
    uint64_t n_points = 0;
    for (uint32_t i = 0; i < curves->n_curves; i++, bytes += CURVE_BYTES) {
        if (!curve_unpack(bytes, &record) || record.points > curves->n_points - n_points)
            return false;
        memory->curves[i] = (struct sheen_curve){
            .light = record.light,
            .line = record.line,
            .place = record.place,
            .is_closed = record.is_closed,
            .n_points = (size_t)record.points,
            .points = memory->points + n_points,
            .length = record.length,
        };
        n_points += record.points;
    }
    return n_points == curves->n_points;
}

static bool fill_records(struct sheen_curves *curves, const uint8_t *bytes)
{
    struct sheen_curves_memory *memory = curves->memory;
    struct curve_point_record point;
    struct curve_mark_record mark;
    if (!fill_curves(curves, bytes))
        return false;
    bytes += (size_t)curves->n_curves * CURVE_BYTES;
    for (uint64_t i = 0; i < curves->n_points; i++, bytes += CURVE_POINT_BYTES) {
        if (!curve_point_unpack(bytes, &point))
            return false;
        fill_point(&memory->points[i], &point);
    }
    for (uint32_t i = 0; i < curves->n_marks; i++, bytes += CURVE_MARK_BYTES) {
        if (!curve_mark_unpack(bytes, &mark))
            return false;
        memory->marks[i] = (struct sheen_curve_mark){
            .kind = (enum sheen_curve_mark_kind)mark.kind,
            .light = mark.light,
            .line = mark.line,
            .face = mark.face,
            .uv = {mark.u, mark.v},
        };
        memcpy(memory->marks[i].position, mark.point, sizeof(mark.point));
        memcpy(memory->marks[i].normal, mark.normal, sizeof(mark.normal));
    }
    return true;
}

static void free_memory(struct sheen_curves_memory *memory)
{
    if (!memory)
        return;
    free(memory->curves);
    free(memory->points);
    free(memory->marks);
    free(memory);
}

/* Makes room for the records. */
static bool allocate(struct sheen_curves *curves)
{
    struct sheen_curves_memory *memory = curves->memory = calloc(1, sizeof(*memory));
    if (!memory)
        return false;
    memory->curves = calloc(curves->n_curves + (size_t)1, sizeof(*memory->curves));
    memory->points = calloc((size_t)curves->n_points + 1, sizeof(*memory->points));
    memory->marks = calloc(curves->n_marks + (size_t)1, sizeof(*memory->marks));
    curves->curves = memory->curves;
    curves->marks = memory->marks;
    return memory->curves && memory->points && memory->marks;
}

static void fill_answer(struct sheen_curves *curves, const sheen_Curves *answer)
{
    *curves = (struct sheen_curves){
        .n_curves = answer->curves,
        .n_points = answer->points,
        .n_marks = answer->marks,
        .tolerance = answer->tolerance,
        .diagonal = answer->diagonal,
        .total_us = answer->total_us,
        .n_lights = answer->lights_count,
    };
    scene_camera_from_message(&curves->camera, &answer->camera);
    scene_lines_from_message(&curves->lines, &answer->lines);
    for (uint32_t i = 0; i < curves->n_lights; i++)
        scene_light_from_message(&curves->lights[i], &answer->lights[i]);
    memcpy(curves->server, answer->server, sizeof(curves->server));
}

/* Asks, and fills in a result of this library's own size. */
static enum sheen_status ask(struct sheen_session *session, const sheen_TraceLines *asked,
                             const struct sheen_progress *progress, struct sheen_curves *curves,
                             struct sheen_error *error)
{
    sheen_Curves answer;
    uint8_t *data = NULL;
    enum sheen_status status = compute_run(session, MESSAGE_TRACE_LINES, asked, MESSAGE_CURVES,
                                           &answer, &answer.data_bytes, progress, &data, error);
    if (status)
        return status;
    fill_answer(curves, &answer);
    if (!allocate(curves)) {
        status_set(error, SHEEN_NO_MEMORY, "no memory for %u curves", curves->n_curves);
        status = session_fail(session, SHEEN_NO_MEMORY, error);
    } else if (!fill_records(curves, data)) {
        status = session_bad_peer(session, error, MESSAGE_CURVES, "a record is out of its range");
    }
    free(data);
    return status;
}

/* Copies the options into the request. */
static enum sheen_status take_options(sheen_TraceLines *asked,
                                      const struct sheen_curve_options *options,
                                      struct sheen_error *error)
{
    struct sheen_curve_options whole = SHEEN_CURVE_OPTIONS_DEFAULTS;
    enum sheen_status status =
        options ? sized_take(&whole, sizeof(whole), options, "options", error) : SHEEN_OK;
    if (status)
        return status;
    if (whole.n_at > SHEEN_MAX_CURVE_PLACES)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%u places; there may be %d", whole.n_at,
                          SHEEN_MAX_CURVE_PLACES);
    asked->has_tolerance = whole.tolerance != 0;
    asked->tolerance = whole.tolerance;
    asked->has_silhouettes = asked->silhouettes = whole.silhouettes;
    asked->at_count = (pb_size_t)whole.n_at;
    for (uint32_t i = 0; i < whole.n_at; i++)
        asked->at[i] = whole.at[i];
    return SHEEN_OK;
}

enum sheen_status sheen_trace_lines(struct sheen_session *session,
                                    const struct sheen_request *request,
                                    const struct sheen_curve_options *options,
                                    const struct sheen_progress *progress,
                                    struct sheen_curves *curves, struct sheen_error *error)
{
    char text[MESSAGE_TEXT_BYTES];
    sheen_TraceLines asked = sheen_TraceLines_init_zero;
    enum sheen_status status = sized_check(curves, "curves", error);
    if (!status)
        status = take_options(&asked, options, error);
    if (!status)
        status = compute_scene(session, request, "trace lines", &asked.scene, error);
    if (status)
        return status;
    if (!message_check_trace_lines(&asked, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    sheen_curves_finish(curves);
    struct sheen_curves result = {.n_curves = 0};
    status = ask(session, &asked, progress, &result, error);
    if (status)
        free_memory(result.memory);
    else
        sized_give(curves, &result, sizeof(result));
    return status;
}

void sheen_curves_finish(struct sheen_curves *curves)
{
    if (!curves)
        return;
    free_memory(curves->memory);
    if (curves->size)
        sheen_struct_init(curves, curves->size);
}
