/* FIND_BREAKS: where the surface's lines break. */
#include <stdio.h>

#include "protocol/break_records.h"
#include "server/base/clock.h"
#include "server/curves/breaks/breaks.h"
#include "server/frame/compute.h"
#include "server/scene/scene_convert.h"

static const sheen_Render *scene_of(const union compute_asked *asked)
{
    return &asked->find_breaks.scene;
}

/* The limits asked for, or their defaults (README.md of protocol/). */
static struct break_limits limits_of(const struct compute *compute)
{
    const sheen_FindBreaks *asked = &compute->asked.find_breaks;
    const double gap = 1e-5 * breaks_diagonal(compute->tables[0]);
    return (struct break_limits){
        .gap = asked->has_gap ? asked->gap
               : gap > 0      ? gap
                              : 1, /* a model of one point */
        .angle_deg = asked->angle_deg,
        .curvature_percent = asked->curvature_percent,
    };
}

static uint64_t bytes_of(const struct compute *compute)
{
    return breaks_bytes(compute->tables[0]);
}

static struct computation *create(const struct compute *compute, struct error *error)
{
    const struct break_lines lines = {&compute->scene.lines, compute->scene.lights,
                                      compute->scene.n_lights};
    const struct break_limits limits = limits_of(compute);
    return breaks_create(compute->tables[0], &lines, &limits, error);
}

static bool pack_records(struct compute *compute, const struct breaks_found *result,
                         struct error *error)
{
    compute->records_bytes =
        result->n_edges * BREAK_EDGE_BYTES + result->n_vertices * BREAK_VERTEX_BYTES;
    if (compute->records_bytes == 0)
        return true;
    compute->records =
        block_cache_take(compute->request->host->block_cache, compute->records_bytes);
    if (!compute->records)
        return error_set(error, ERROR_SERVER, "no memory for the breaks: try again later");
    uint8_t *to = compute->records;
    for (size_t i = 0; i < result->n_edges; i++, to += BREAK_EDGE_BYTES)
        break_edge_pack(&result->edges[i], to);
    for (size_t i = 0; i < result->n_vertices; i++, to += BREAK_VERTEX_BYTES)
        break_vertex_pack(&result->vertices[i], to);
    return true;
}

static bool pack(struct compute *compute, struct error *error)
{
    const struct breaks_found result = breaks_result(compute->computation);
    const struct break_limits limits = limits_of(compute);
    const struct break_counts *counts = &result.counts;
    const struct frame_request *scene = &compute->scene;
    if (!pack_records(compute, &result, error))
        return false;
    sheen_Breaks *answer = &compute->answer.breaks;
    *answer = (sheen_Breaks){
        .data_bytes = compute->records_bytes,
        .edges = (uint32_t)result.n_edges,
        .vertices = (uint32_t)result.n_vertices,
        .edges_out = counts->edges_out,
        .gap = limits.gap,
        .angle_deg = limits.angle_deg,
        .curvature_percent = limits.curvature_percent,
        .creases = counts->creases,
        .semisharp = counts->semisharp,
        .joints = counts->joints,
        .borders = counts->borders,
        .creases_length = counts->creases_length,
        .borders_length = counts->borders_length,
        .out_length = counts->out_length,
        .diagonal = breaks_diagonal(compute->tables[0]),
        .camera = scene_write_camera(&scene->camera),
        .lines = scene_write_lines(&scene->lines),
        .lights_count = (pb_size_t)scene->n_lights,
        .total_us = clock_now_us() - compute->request->start_us,
    };
    const sheen_Render *asked = &compute->request->render;
    for (uint32_t i = 0; i < scene->n_lights; i++)
        answer->lights[i] = scene_write_light(&scene->lights[i],
                                              i < asked->lights_count ? &asked->lights[i] : NULL);
    snprintf(answer->server, sizeof answer->server, "%s", SHEEN_VERSION);
    return true;
}

const struct compute_kind compute_breaks_kind = {
    .answer = MESSAGE_BREAKS,
    .what = "finding breaks",
    .scene = scene_of,
    .bytes = bytes_of,
    .create = create,
    .pack = pack,
};
