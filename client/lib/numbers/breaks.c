/* sheen_find_breaks(). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client/lib/numbers/compute.h"
#include "client/lib/scene_convert.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"
#include "protocol/break_records.h"

/* The memory that a result owns. */
struct sheen_breaks_memory {
    struct sheen_break_edge *edges;
    struct sheen_break_vertex *vertices;
};

_Static_assert((int)SHEEN_BREAK_GAP == (int)BREAK_GAP && (int)SHEEN_BREAK_JUMP == (int)BREAK_JUMP &&
                   (int)SHEEN_N_BREAK_MEASURES == (int)BREAK_MEASURES,
               "measures have the same numbers on the wire");
_Static_assert((int)SHEEN_BREAK_CREASE == (int)BREAK_CREASE &&
                   (int)SHEEN_BREAK_JOINT == (int)BREAK_JOINT,
               "kinds have the same numbers on the wire");

/* (u,v) of a face at a place of its edge. */
static void place_uv(unsigned edge, double at, double uv[2])
{
    const double u[4] = {at, 1, 1 - at, 0}, v[4] = {0, at, 1, 1 - at};
    uv[0] = u[edge];
    uv[1] = v[edge];
}

static void fill_edge(struct sheen_break_edge *to, const struct break_edge *from)
{
    *to = (struct sheen_break_edge){
        .kind = (enum sheen_break_kind)from->kind,
        .faces = {from->face[0], from->face[1]},
        .edges = {from->edge[0], from->edge[1]},
        .over = from->over,
        .has_dart = from->has_dart,
        .kink_light = from->kink_light,
        .jump_light = from->jump_light,
        .length = from->length,
        .out_length = from->out_length,
        .shift = from->shift,
    };
    for (int i = 0; i < SHEEN_N_BREAK_MEASURES; i++) {
        struct sheen_break_worst *worst = &to->worst[i];
        worst->value = from->worst[i].value;
        memcpy(worst->position, from->worst[i].point, sizeof(worst->position));
        place_uv(from->edge[0], from->worst[i].at, worst->uv);
    }
}

static bool fill_records(struct sheen_breaks *breaks, const uint8_t *bytes)
{
    struct break_edge edge;
    struct break_vertex vertex;
    struct sheen_breaks_memory *memory = breaks->memory;
    for (uint32_t i = 0; i < breaks->n_edges; i++, bytes += BREAK_EDGE_BYTES) {
        if (!break_edge_unpack(bytes, &edge))
            return false;
        fill_edge(&memory->edges[i], &edge);
    }
    for (uint32_t i = 0; i < breaks->n_vertices; i++, bytes += BREAK_VERTEX_BYTES) {
        if (!break_vertex_unpack(bytes, &vertex))
            return false;
        memory->vertices[i] = (struct sheen_break_vertex){
            .face = vertex.face,
            .corner = vertex.corner,
            .n_faces = vertex.n_faces,
            .is_inside = vertex.is_inside,
            .radius = vertex.radius,
            .k_least = vertex.k_least,
            .k_greatest = vertex.k_greatest,
        };
        memcpy(memory->vertices[i].position, vertex.point, sizeof(vertex.point));
    }
    return true;
}

static void free_memory(struct sheen_breaks_memory *memory)
{
    if (!memory)
        return;
    free(memory->edges);
    free(memory->vertices);
    free(memory);
}

/* Makes room for the records. */
static bool allocate(struct sheen_breaks *breaks)
{
    struct sheen_breaks_memory *memory = breaks->memory = calloc(1, sizeof(*memory));
    if (!memory)
        return false;
    memory->edges = calloc(breaks->n_edges + (size_t)1, sizeof(*memory->edges));
    memory->vertices = calloc(breaks->n_vertices + (size_t)1, sizeof(*memory->vertices));
    breaks->edges = memory->edges;
    breaks->vertices = memory->vertices;
    return memory->edges && memory->vertices;
}

static void fill_breaks(struct sheen_breaks *breaks, const sheen_Breaks *answer)
{
    *breaks = (struct sheen_breaks){
        .n_edges = answer->edges,
        .n_vertices = answer->vertices,
        .n_out = answer->edges_out,
        .n_creases = answer->creases,
        .n_semisharp = answer->semisharp,
        .n_joints = answer->joints,
        .n_borders = answer->borders,
        .gap = answer->gap,
        .angle_deg = answer->angle_deg,
        .curvature_percent = answer->curvature_percent,
        .creases_length = answer->creases_length,
        .borders_length = answer->borders_length,
        .out_length = answer->out_length,
        .diagonal = answer->diagonal,
        .total_us = answer->total_us,
        .n_lights = answer->lights_count,
    };
    scene_camera_from_message(&breaks->camera, &answer->camera);
    scene_lines_from_message(&breaks->lines, &answer->lines);
    for (uint32_t i = 0; i < breaks->n_lights; i++)
        scene_light_from_message(&breaks->lights[i], &answer->lights[i]);
    memcpy(breaks->server, answer->server, sizeof(breaks->server));
}

/* Asks, and fills in a result of this library's own size. */
static enum sheen_status ask(struct sheen_session *session, const sheen_FindBreaks *asked,
                             const struct sheen_progress *progress, struct sheen_breaks *breaks,
                             struct sheen_error *error)
{
    sheen_Breaks answer;
    uint8_t *data = NULL;
    enum sheen_status status = compute_run(session, MESSAGE_FIND_BREAKS, asked, MESSAGE_BREAKS,
                                           &answer, &answer.data_bytes, progress, &data, error);
    if (status)
        return status;
    fill_breaks(breaks, &answer);
    if (!allocate(breaks)) {
        status_set(error, SHEEN_NO_MEMORY, "no memory for %u breaks", breaks->n_edges);
        status = session_fail(session, SHEEN_NO_MEMORY, error);
    } else if (!fill_records(breaks, data)) {
        status = session_bad_peer(session, error, MESSAGE_BREAKS, "a record is out of its range");
    }
    free(data);
    return status;
}

enum sheen_status sheen_find_breaks(struct sheen_session *session,
                                    const struct sheen_request *request,
                                    const struct sheen_break_limits *limits,
                                    const struct sheen_progress *progress,
                                    struct sheen_breaks *breaks, struct sheen_error *error)
{
    char text[MESSAGE_TEXT_BYTES];
    struct sheen_break_limits whole = SHEEN_BREAK_LIMITS_DEFAULTS;
    sheen_FindBreaks asked = sheen_FindBreaks_init_zero;
    enum sheen_status status = sized_check(breaks, "breaks", error);
    if (!status && limits)
        status = sized_take(&whole, sizeof(whole), limits, "limits", error);
    if (!status)
        status = compute_scene(session, request, "find breaks", &asked.scene, error);
    if (status)
        return status;
    asked.has_gap = whole.gap != 0;
    asked.gap = whole.gap;
    asked.has_angle_deg = whole.angle_deg != 0;
    asked.angle_deg = whole.angle_deg;
    asked.has_curvature_percent = whole.curvature_percent != 0;
    asked.curvature_percent = whole.curvature_percent;
    if (!message_check_find_breaks(&asked, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    sheen_breaks_finish(breaks);
    struct sheen_breaks result = {.n_edges = 0};
    status = ask(session, &asked, progress, &result, error);
    if (status)
        free_memory(result.memory);
    else
        sized_give(breaks, &result, sizeof(result));
    return status;
}

void sheen_breaks_finish(struct sheen_breaks *breaks)
{
    if (!breaks)
        return;
    free_memory(breaks->memory);
    if (breaks->size)
        sheen_struct_init(breaks, breaks->size);
}
