#include "server/cage/read/weld.h"

#include <stdlib.h>
#include <string.h>

#include "server/cage/hash.h"

#define EMPTY UINT32_MAX

static uint64_t position_hash(const double position[3], uint64_t seed)
{
    uint64_t hash = seed;
    for (int i = 0; i < 3; i++) {
        double value = position[i] + 0.0; /* -0 and 0 are one place */
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = hash_mix(hash ^ bits, seed);
    }
    return hash;
}

static bool same_place(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Moves the vertices that stay to the front of cage->position and says in map[] where each of the
 * old ones went. */
static bool weld_vertices(struct cage *cage, uint32_t *map)
{
    size_t slots = 16;
    while (slots < 2 * cage->n_vertices)
        slots *= 2;
    uint32_t *table = malloc(slots * sizeof *table);
    if (!table)
        return false;
    memset(table, 0xff, slots * sizeof *table);
    uint64_t seed = hash_seed();
    uint32_t kept = 0;
    for (size_t v = 0; v < cage->n_vertices; v++) {
        const double *position = cage->position[v];
        size_t slot = (size_t)position_hash(position, seed) & (slots - 1);
        while (table[slot] != EMPTY && !same_place(cage->position[table[slot]], position))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == EMPTY) {
            table[slot] = kept;
            memmove(cage->position[kept++], position, sizeof *cage->position);
        }
        map[v] = table[slot];
    }
    cage->n_vertices = kept;
    free(table);
    return true;
}

/* Maps the corners of one face in place, moved down to `out`, and returns how many stay. */
static uint32_t weld_face(uint32_t *out, const uint32_t *corner, uint32_t n, const uint32_t *map)
{
    uint32_t first = corner[0], previous = first, kept = 1;
    out[0] = map[first];
    for (uint32_t c = 1; c < n; c++) {
        uint32_t vertex = corner[c];
        if (vertex == previous || map[vertex] != map[previous])
            out[kept++] = map[vertex];
        previous = vertex;
    }
    if (kept > 1 && previous != first && out[kept - 1] == out[0])
        kept--;
    return kept;
}

/* Returns how many faces fell flat. face_map[] says where the others went, EMPTY for those. */
static size_t weld_faces(struct cage_builder *builder, const uint32_t *map, uint32_t *face_map)
{
    struct cage *cage = &builder->cage;
    uint32_t kept_faces = 0, kept_corners = 0, first = 0;
    for (size_t f = 0; f < cage->n_faces; f++) {
        uint32_t last = cage->face_start[f + 1];
        uint32_t n = last - first;
        uint32_t kept =
            weld_face(&cage->face_vertex[kept_corners], &cage->face_vertex[first], n, map);
        first = last;
        face_map[f] = EMPTY;
        if (kept < 3 && kept < n)
            continue;
        kept_corners += kept;
        face_map[f] = kept_faces;
        builder->face_line[kept_faces] = builder->face_line[f];
        cage->face_start[++kept_faces] = kept_corners;
    }
    size_t dropped = cage->n_faces - kept_faces;
    cage->n_faces = kept_faces;
    builder->n_face_vertices = kept_corners;
    return dropped;
}

static void weld_tags(struct cage_builder *builder, const uint32_t *map, const uint32_t *face_map,
                      const char *name)
{
    struct cage *cage = &builder->cage;
    size_t kept = 0;
    for (size_t i = 0; i < cage->n_creases; i++) {
        struct cage_crease crease = cage->crease[i];
        bool was_edge = crease.vertex[0] != crease.vertex[1];
        crease.vertex[0] = map[crease.vertex[0]];
        crease.vertex[1] = map[crease.vertex[1]];
        if (!was_edge || crease.vertex[0] != crease.vertex[1])
            cage->crease[kept++] = crease;
    }
    if (kept < cage->n_creases)
        cage_warn(cage, "%s: creases dropped, their ends fall together: %zu", name,
                  cage->n_creases - kept);
    cage->n_creases = kept;
    for (size_t i = 0; i < cage->n_corners; i++)
        cage->corner[i].vertex = map[cage->corner[i].vertex];
    kept = 0;
    for (size_t i = 0; i < cage->n_holes; i++)
        if (face_map[cage->hole[i]] != EMPTY)
            cage->hole[kept++] = face_map[cage->hole[i]];
    cage->n_holes = kept;
}

bool cage_weld(struct cage_builder *builder, const char *name, struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_vertices == 0 || cage->n_faces == 0)
        return true;
    uint32_t *map = malloc(cage->n_vertices * sizeof *map);
    uint32_t *face_map = malloc(cage->n_faces * sizeof *face_map);
    bool ok = map && face_map && weld_vertices(cage, map);
    if (ok) {
        size_t dropped = weld_faces(builder, map, face_map);
        if (dropped > 0)
            cage_warn(cage, "%s: faces dropped, their corners fall together: %zu", name, dropped);
        weld_tags(builder, map, face_map, name);
    } else {
        error_set(error, ERROR_SERVER, "%s: not enough memory to weld %zu vertices", name,
                  cage->n_vertices);
    }
    free(map);
    free(face_map);
    return ok;
}
