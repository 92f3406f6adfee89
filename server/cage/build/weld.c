#include "server/cage/build/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/cage/hash.h"

#define EMPTY UINT32_MAX

/* The same number for equal coordinates: for -0 and 0, and for all NaN. */
static uint64_t coordinate_bits(double value)
{
    uint64_t bits;
    if (isnan(value))
        return UINT64_MAX;
    value += 0.0;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint64_t position_hash(const double position[3], uint64_t seed)
{
    uint64_t hash = seed;
    for (int i = 0; i < 3; i++)
        hash = hash_mix(hash ^ coordinate_bits(position[i]), seed);
    return hash;
}

static bool same_place(const double a[3], const double b[3])
{
    return coordinate_bits(a[0]) == coordinate_bits(b[0]) &&
           coordinate_bits(a[1]) == coordinate_bits(b[1]) &&
           coordinate_bits(a[2]) == coordinate_bits(b[2]);
}

/* Moves the remaining vertices from `first` on to the front, and sets map[] to the new index of
 * each old one. */
static bool weld_vertices(struct cage *cage, size_t first, uint32_t *map)
{
    size_t slots = 16;
    while (slots < 2 * (cage->n_vertices - first))
        slots *= 2;
    uint32_t *table = malloc(slots * sizeof *table);
    if (!table)
        return false;
    memset(table, 0xff, slots * sizeof *table);
    uint64_t seed = hash_seed();
    uint32_t kept = (uint32_t)first;
    for (size_t v = first; v < cage->n_vertices; v++) {
        const double *position = cage->position[v];
        size_t slot = (size_t)position_hash(position, seed) & (slots - 1);
        while (table[slot] != EMPTY && !same_place(cage->position[table[slot]], position))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == EMPTY) {
            table[slot] = kept;
            memmove(cage->position[kept++], position, sizeof *cage->position);
        }
        map[v - first] = table[slot];
    }
    cage->n_vertices = kept;
    free(table);
    return true;
}

/* Tags may name vertices that do not exist. */
static void weld_tag(uint32_t *vertex, const uint32_t *map, size_t first, size_t n)
{
    if (*vertex >= first && *vertex - first < n)
        *vertex = map[*vertex - first];
}

struct weld_start weld_begin(const struct cage_builder *builder)
{
    const struct cage *cage = &builder->cage;
    return (struct weld_start){.vertices = cage->n_vertices,
                               .face_vertices = builder->n_face_vertices,
                               .creases = cage->n_creases,
                               .corners = cage->n_corners};
}

bool cage_weld(struct cage_builder *builder, const struct weld_start *start, const char *name,
               struct error *error)
{
    struct cage *cage = &builder->cage;
    size_t first = start->vertices, n = cage->n_vertices - first;
    if (n == 0)
        return true;
    uint32_t *map = malloc(n * sizeof *map);
    bool ok = map && weld_vertices(cage, first, map);
    if (!ok) {
        free(map);
        return error_set(error, ERROR_SERVER, "%s: not enough memory to weld %zu vertices", name,
                         n);
    }
    for (size_t i = start->face_vertices; i < builder->n_face_vertices; i++)
        cage->face_vertex[i] = map[cage->face_vertex[i] - first];
    for (size_t i = start->creases; i < cage->n_creases; i++)
        for (int end = 0; end < 2; end++)
            weld_tag(&cage->crease[i].vertex[end], map, first, n);
    for (size_t i = start->corners; i < cage->n_corners; i++)
        weld_tag(&cage->corner[i].vertex, map, first, n);
    free(map);
    return true;
}
