#include "server/surface/subdivision/dart_mask_list.h"

#include <stdlib.h>

#include "server/cage/cage.h"
#include "server/surface/subdivision/crease.h"

static const struct dart_mask_list *look_up(const struct dart_mask_list *list,
                                            const struct ring *ring)
{
    while (list && list->n_faces != ring->n_faces)
        list = list->older;
    return list;
}

void dart_mask_list_add(struct dart_mask_list **list, const struct ring *ring, struct arena *arena)
{
    if (ring->n_faces < DART_MASK_LIST_MIN_FACES || look_up(*list, ring))
        return;
    struct dart_mask_list *made = malloc(sizeof *made);
    if (!made)
        return;
    *made = (struct dart_mask_list){.n_faces = ring->n_faces, .older = *list};
    size_t mark = arena->used;
    struct ring like = ring_take(arena, ring->n_faces, true, true);
    like.creases.edge[0] = CAGE_SHARPNESS_INFINITE;
    dart_masks_find(&made->masks, &like, arena);
    arena->used = mark;
    *list = made;
}

void dart_mask_list_finish(struct dart_mask_list **list)
{
    for (struct dart_mask_list *known = *list, *older; known; known = older) {
        older = known->older;
        free(known);
    }
    *list = NULL;
}

/* Turns a mask for a ring whose edge `by` corresponds to the mask's edge 0. */
static void turn(const double *mask, uint32_t n, uint32_t by, double *out)
{
    out[0] = mask[0];
    for (uint32_t k = 0; k < n; k++) {
        uint32_t to = (k + by) % n;
        out[1 + to] = mask[1 + k];
        out[1 + n + to] = mask[1 + n + k];
    }
}

void dart_mask_list_find(const struct dart_mask_list *list, const struct ring *ring,
                         struct arena *arena, struct dart_masks *masks)
{
    const struct dart_mask_list *known = look_up(list, ring);
    if (!known) {
        dart_masks_find(masks, ring, arena);
        return;
    }
    uint32_t edge[2];
    crease_vertex_rule(ring, edge);
    turn(known->masks.position, ring->n_faces, edge[0], masks->position);
    for (int k = 0; k < 2; k++)
        turn(known->masks.tangent[k], ring->n_faces, edge[0], masks->tangent[k]);
}
