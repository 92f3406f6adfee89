/* The modes (dart_masks.h) of a cage's darts of many faces: found while its plan is made, since they
 * take 0.1 s at 64 faces and are the same wherever the ring's points lie. */
#ifndef SHEEN_SURFACE_SUBDIVISION_DART_MASK_LIST_H
#define SHEEN_SURFACE_SUBDIVISION_DART_MASK_LIST_H

#include "server/surface/subdivision/dart_masks.h"

/* Rings of fewer faces take 0.3 ms. */
enum { DART_MASK_LIST_MIN_FACES = 9 };

/* A list, empty: NULL; one for each number of faces. The sharp edge is the ring's first. */
struct dart_mask_list {
    uint32_t n_faces;
    struct dart_masks modes;
    struct dart_mask_list *older;
};

/* Adds those of a dart's ring of at most DART_MAX_VALENCE faces, unless it has few, or they are
 * there, or memory is short. */
void dart_mask_list_add(struct dart_mask_list **list, const struct ring *ring, struct arena *arena);
void dart_mask_list_finish(struct dart_mask_list **list);

/* dart_masks_find(), but by the list where they are there. */
void dart_mask_list_find(const struct dart_mask_list *list, const struct ring *ring,
                         struct arena *arena, struct dart_masks *modes);

#endif
