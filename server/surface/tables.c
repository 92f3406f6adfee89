#include "server/surface/tables.h"

#include "server/surface/support.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/surface/subdivision/face.h"

static_assert(sizeof(struct limit_node) == 48, "three RGBA32UI texels");
static_assert(sizeof(struct limit_adjacency) == 16, "one RGBA32UI texel");

static void bounding_box(const struct cage *cage, double box_min[3], double box_max[3])
{
    for (int k = 0; k < 3; k++) {
        box_min[k] = INFINITY;
        box_max[k] = -INFINITY;
    }
    for (size_t c = 0; c < cage->face_start[cage->n_faces]; c++) {
        const double *p = cage->position[cage->face_vertex[c]];
        for (int k = 0; k < 3; k++) {
            box_min[k] = fmin(box_min[k], p[k]);
            box_max[k] = fmax(box_max[k], p[k]);
        }
    }
}

bool limit_tables_init(struct limit_tables *tables, const struct limit_plan *plan,
                       struct error *error)
{
    struct plan_offsets total = plan->offsets[plan->n_ptex];
    *tables = (struct limit_tables){.n_faces = plan->n_ptex,
                                    .n_nodes = total.node,
                                    .n_texels = total.texel,
                                    .n_bounds = total.bound};
    tables->nodes = calloc(tables->n_nodes, sizeof *tables->nodes);
    tables->adjacency = malloc(tables->n_faces * sizeof *tables->adjacency);
    tables->texels = malloc((tables->n_texels + 1) * sizeof *tables->texels);
    tables->bound_first = malloc(tables->n_nodes * sizeof *tables->bound_first);
    tables->bounds = malloc((tables->n_bounds + 1) * sizeof *tables->bounds);
    if (!tables->nodes || !tables->adjacency || !tables->texels || !tables->bound_first ||
        !tables->bounds) {
        size_t bytes = limit_tables_host_bytes(tables);
        limit_tables_finish(tables);
        return error_set(error, ERROR_SERVER, "out of memory: the tables need %zu bytes", bytes);
    }
    bounding_box(plan->cage, tables->hull_min, tables->hull_max);
    memcpy(tables->box_min, plan->box_min, sizeof tables->box_min);
    memcpy(tables->box_max, plan->box_max, sizeof tables->box_max);
    tables->n_regular = plan->n_regular;
    tables->n_corner = plan->n_corner;
    tables->n_strip = plan->n_strip;
    tables->n_split = plan->n_split;
    tables->n_hole = plan->n_hole;
    return true;
}

void limit_tables_finish(struct limit_tables *tables)
{
    free(tables->nodes);
    free(tables->adjacency);
    free(tables->texels);
    free(tables->bound_first);
    free(tables->bounds);
    free(tables->support);
    *tables = (struct limit_tables){0};
}

size_t limit_tables_bytes(const struct limit_tables *tables)
{
    return tables->n_nodes * sizeof *tables->nodes + tables->n_faces * sizeof *tables->adjacency +
           tables->n_texels * sizeof *tables->texels;
}

size_t limit_tables_host_bytes(const struct limit_tables *tables)
{
    return limit_tables_bytes(tables) + tables->n_nodes * sizeof *tables->bound_first +
           tables->n_bounds * sizeof *tables->bounds +
           limit_support_room(tables) * sizeof *tables->support;
}

bool limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan, size_t first,
                       size_t last, const struct limit_watch *watch, struct error *error)
{
    struct face_builder builder = {.tables = tables, .plan = plan};
    if (!arena_init(&builder.arena, plan->arena_bytes))
        return error_set(error, ERROR_SERVER, "out of memory while building tables");
    ring_cache_init(&builder.rings, plan->cage->face_start[plan->cage->n_faces]);
    bool ok = true;
    for (size_t p = first; p < last && (ok = limit_goes_on(watch, error)); p++) {
        builder.next = plan->offsets[p];
        face_build(&builder, (uint32_t)p);
        assert(builder.next.node == plan->offsets[p + 1].node);
        assert(builder.next.texel == plan->offsets[p + 1].texel);
    }
    ring_cache_finish(&builder.rings);
    arena_finish(&builder.arena);
    return ok;
}
