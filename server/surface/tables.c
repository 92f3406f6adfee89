#include "server/surface/tables.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "server/surface/record_cache.h"
#include "server/surface/source.h"
#include "server/surface/texels.h"

static_assert(sizeof(struct limit_node) == 48, "three RGBA32UI texels");
static_assert(sizeof(struct limit_adjacency) == 16, "one RGBA32UI texel");
static_assert(sizeof(struct limit_bound) % 8 == 0, "a record of a cache");

/* The number of bounds that tables on demand keep. */
enum { MOST_LEVEL_BOUNDS = 1 << 19 };

size_t limit_view_levels(const struct limit_tables *tables)
{
    size_t n = LIMIT_VIEW_LEVELS * (tables->count[LIMIT_CORNER] + tables->count[LIMIT_STRIP]);
    return n < tables->n_bounds ? n : tables->n_bounds;
}

static size_t level_bounds_of(const struct limit_tables *tables)
{
    size_t n = limit_view_levels(tables);
    return n < MOST_LEVEL_BOUNDS ? n : MOST_LEVEL_BOUNDS;
}

static bool init(struct limit_tables *tables, const struct limit_size *size, bool stored,
                 struct error *error)
{
    *tables = (struct limit_tables){.on_demand = !stored,
                                    .n_faces = size->n_faces,
                                    .n_nodes = size->n_nodes,
                                    .n_texels = size->n_texels,
                                    .n_bounds = size->n_bounds};
    tables->nodes = calloc(tables->n_nodes, sizeof *tables->nodes);
    tables->adjacency = malloc(tables->n_faces * sizeof *tables->adjacency);
    tables->heads = malloc(tables->n_nodes * sizeof *tables->heads);
    tables->whole = malloc(tables->n_nodes * sizeof *tables->whole);
    tables->bends = size->has_bends ? calloc(tables->n_faces, 1) : NULL;
    bool has_levels;
    memcpy(tables->count, size->count, sizeof tables->count);
    if (stored) {
        tables->texels = malloc((tables->n_texels + 1) * sizeof *tables->texels);
        tables->bound_first = malloc(tables->n_nodes * sizeof *tables->bound_first);
        tables->bounds = malloc((tables->n_bounds + 1) * sizeof *tables->bounds);
        has_levels = tables->texels && tables->bound_first && tables->bounds;
    } else {
        tables->source = size->source;
        tables->source->keep(tables->source);
        tables->level_bounds =
            record_cache_create(sizeof(struct limit_bound), level_bounds_of(tables));
        has_levels = tables->level_bounds;
    }
    if (!tables->nodes || !tables->adjacency || !tables->heads || !tables->whole || !has_levels ||
        (size->has_bends && !tables->bends)) {
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

bool limit_tables_init(struct limit_tables *tables, const struct limit_size *size,
                       struct error *error)
{
    return init(tables, size, true, error);
}

bool limit_tables_init_on_demand(struct limit_tables *tables, const struct limit_size *size,
                                 struct error *error)
{
    return init(tables, size, false, error);
}

void limit_tables_finish(struct limit_tables *tables)
{
    free(tables->nodes);
    free(tables->adjacency);
    free(tables->heads);
    free(tables->bends);
    free(tables->whole);
    free(tables->texels);
    free(tables->bound_first);
    free(tables->bounds);
    free(tables->support);
    record_cache_destroy(tables->level_bounds);
    if (tables->source)
        tables->source->drop(tables->source);
    *tables = (struct limit_tables){0};
}

struct limit_bound limit_level_bound(const struct limit_tables *tables, uint32_t node, unsigned n)
{
    if (tables->bounds)
        return tables->bounds[tables->bound_first[node] + n - 1];
    struct limit_bound bound;
    uint64_t key = record_cache_key(node, n);
    const void *known = record_cache_find(tables->level_bounds, key);
    if (known) {
        memcpy(&bound, known, sizeof bound);
        return bound;
    }
    tables->source->make(tables->source, tables, node, n, NULL, &bound);
    record_cache_add(tables->level_bounds, key, &bound);
    return bound;
}

void limit_tables_turn(const struct limit_tables *tables)
{
    if (tables->level_bounds)
        record_cache_turn(tables->level_bounds);
}

/* Bytes of a node without its points. */
static size_t whole_bytes(const struct limit_tables *tables)
{
    return sizeof *tables->heads + sizeof *tables->whole;
}

size_t limit_tables_bytes(const struct limit_tables *tables)
{
    size_t bytes =
        tables->n_nodes * sizeof *tables->nodes + tables->n_faces * sizeof *tables->adjacency;
    return bytes + (tables->on_demand ? tables->n_nodes * whole_bytes(tables)
                                      : tables->n_texels * sizeof *tables->texels);
}

size_t limit_support_room(const struct limit_tables *tables)
{
    const size_t of_node = (LIMIT_SUPPORT_STEPS + 1) * (LIMIT_SUPPORT_STEPS + 1);
    size_t n_leaves = tables->count[LIMIT_REGULAR] + tables->count[LIMIT_CORNER] +
                      tables->count[LIMIT_STRIP]; /* 0 for a model without a surface */
    return n_leaves < LIMIT_MAX_SUPPORT / of_node ? n_leaves * of_node : LIMIT_MAX_SUPPORT;
}

size_t limit_tables_host_bytes(const struct limit_tables *tables)
{
    size_t bytes =
        limit_tables_bytes(tables) + limit_support_room(tables) * sizeof *tables->support +
        (tables->bends ? tables->n_faces : 0) + (tables->source ? tables->source->bytes : 0);
    if (tables->on_demand)
        return bytes + record_cache_most_bytes(sizeof(struct limit_bound), level_bounds_of(tables));
    return bytes + tables->n_nodes * (whole_bytes(tables) + sizeof *tables->bound_first) +
           tables->n_bounds * sizeof *tables->bounds;
}

size_t limit_face_bytes(const struct limit_tables *tables, enum limit_kind kind)
{
    size_t texels =
        kind == LIMIT_CORNER ? LIMIT_CORNER_TEXELS(LIMIT_MAX_LEVELS) : LIMIT_PATCH_TEXELS;
    return sizeof(struct limit_node) + sizeof(struct limit_adjacency) +
           (tables->on_demand ? whole_bytes(tables) : texels * sizeof(float[4]));
}
