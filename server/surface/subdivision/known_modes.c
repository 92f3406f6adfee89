#include "server/surface/subdivision/known_modes.h"

#include <stdlib.h>

#include "server/cage/cage.h"
#include "server/surface/subdivision/crease.h"

static const struct known_modes *look_up(const struct known_modes *list, const struct ring *ring)
{
    while (list && list->n_faces != ring->n_faces)
        list = list->older;
    return list;
}

void known_modes_add(struct known_modes **list, const struct ring *ring, struct arena *arena)
{
    if (ring->n_faces < KNOWN_MODES_MIN_FACES || look_up(*list, ring))
        return;
    struct known_modes *made = malloc(sizeof *made);
    if (!made)
        return;
    *made = (struct known_modes){.n_faces = ring->n_faces, .older = *list};
    size_t mark = arena->used;
    struct ring like = ring_take(arena, ring->n_faces, true, true);
    like.creases.edge[0] = CAGE_SHARPNESS_INFINITE;
    ring_modes_init(&made->modes, &like, arena);
    arena->used = mark;
    *list = made;
}

void known_modes_finish(struct known_modes **list)
{
    for (struct known_modes *known = *list, *older; known; known = older) {
        older = known->older;
        free(known);
    }
    *list = NULL;
}

/* A mask of the vertex, its edges and its faces for a ring whose edge `by` was edge 0. */
static void turn(const double *mask, uint32_t n, uint32_t by, double *out)
{
    out[0] = mask[0];
    for (uint32_t k = 0; k < n; k++) {
        uint32_t to = (k + by) % n;
        out[1 + to] = mask[1 + k];
        out[1 + n + to] = mask[1 + n + k];
    }
}

void known_modes_find(const struct known_modes *list, const struct ring *ring, struct arena *arena,
                      struct ring_modes *modes)
{
    const struct known_modes *known = look_up(list, ring);
    if (!known) {
        ring_modes_init(modes, ring, arena);
        return;
    }
    uint32_t edge[2];
    crease_vertex_rule(ring, edge);
    turn(known->modes.position, ring->n_faces, edge[0], modes->position);
    for (int k = 0; k < 2; k++)
        turn(known->modes.tangent[k], ring->n_faces, edge[0], modes->tangent[k]);
}
