/* A list of the masks (dart_masks.h) of a cage's large darts. Masks depend only on the number of
 * quads, not on points, and take 0.1 s at 64 quads: so they are computed once, when the cage's plan
 * is made. */
#ifndef SHEEN_SURFACE_SUBDIVISION_DART_MASK_LIST_H
#define SHEEN_SURFACE_SUBDIVISION_DART_MASK_LIST_H

#include "server/surface/subdivision/dart_masks.h"

/* Smaller darts are not listed, because their masks take 0.3 ms. */
enum { DART_MASK_LIST_MIN_FACES = 9 };

/* One entry for each number of quads; NULL is the empty list. The masks are for a ring whose first
 * edge is the sharp one. */
struct dart_mask_list {
    uint32_t n_faces;
    struct dart_masks masks;
    struct dart_mask_list *older;
};

/* Adds the masks of a dart's ring of at most DART_MAX_VALENCE quads, unless it is small or listed
 * already. Adds nothing when memory is short. One thread. */
void dart_mask_list_add(struct dart_mask_list **list, const struct ring *ring, struct arena *arena);
void dart_mask_list_finish(struct dart_mask_list **list);

/* Gets the masks of a dart's ring: from the list, turned to its sharp edge, else by
 * dart_masks_find(). Any thread, while nothing is added. */
void dart_mask_list_find(const struct dart_mask_list *list, const struct ring *ring,
                         struct arena *arena, struct dart_masks *masks);

#endif
