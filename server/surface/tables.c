#include "server/surface/tables.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "server/surface/texels.h"

static_assert(sizeof(struct limit_node) == 48, "three RGBA32UI texels");
static_assert(sizeof(struct limit_adjacency) == 16, "one RGBA32UI texel");

bool limit_tables_init(struct limit_tables *tables, const struct limit_size *size,
                       struct error *error)
{
    *tables = (struct limit_tables){.n_faces = size->n_faces,
                                    .n_nodes = size->n_nodes,
                                    .n_texels = size->n_texels,
                                    .n_bounds = size->n_bounds};
    tables->nodes = calloc(tables->n_nodes, sizeof *tables->nodes);
    tables->adjacency = malloc(tables->n_faces * sizeof *tables->adjacency);
    tables->texels = malloc((tables->n_texels + 1) * sizeof *tables->texels);
    tables->bound_first = malloc(tables->n_nodes * sizeof *tables->bound_first);
    tables->bounds = malloc((tables->n_bounds + 1) * sizeof *tables->bounds);
    memcpy(tables->count, size->count, sizeof tables->count);
    if (!tables->nodes || !tables->adjacency || !tables->texels || !tables->bound_first ||
        !tables->bounds) {
        size_t bytes = limit_tables_host_bytes(tables);
        limit_tables_finish(tables);
        return error_set(error, ERROR_SERVER, "out of memory: the tables need %zu bytes", bytes);
    }
    memcpy(tables->box_min, size->box_min, sizeof tables->box_min);
    memcpy(tables->box_max, size->box_max, sizeof tables->box_max);
    memcpy(tables->hull_min, size->hull_min, sizeof tables->hull_min);
    memcpy(tables->hull_max, size->hull_max, sizeof tables->hull_max);
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

size_t limit_support_room(const struct limit_tables *tables)
{
    const size_t of_node = (LIMIT_SUPPORT_STEPS + 1) * (LIMIT_SUPPORT_STEPS + 1);
    size_t n_leaves = tables->count[LIMIT_REGULAR] + tables->count[LIMIT_CORNER] +
                      tables->count[LIMIT_STRIP]; /* a model without surface has none */
    return n_leaves < LIMIT_MAX_SUPPORT / of_node ? n_leaves * of_node : LIMIT_MAX_SUPPORT;
}

size_t limit_tables_host_bytes(const struct limit_tables *tables)
{
    return limit_tables_bytes(tables) + tables->n_nodes * sizeof *tables->bound_first +
           tables->n_bounds * sizeof *tables->bounds +
           limit_support_room(tables) * sizeof *tables->support;
}

size_t limit_face_bytes(enum limit_kind kind)
{
    size_t texels =
        kind == LIMIT_CORNER ? LIMIT_CORNER_TEXELS(LIMIT_MAX_LEVELS) : LIMIT_PATCH_TEXELS;
    return sizeof(struct limit_node) + sizeof(struct limit_adjacency) + texels * sizeof(float[4]);
}
