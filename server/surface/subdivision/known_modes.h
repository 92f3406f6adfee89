/* The modes (modes.h) of a cage's darts of many faces: found while its plan is made, since they
 * take 0.1 s at 64 faces and are the same wherever the ring's points lie. */
#ifndef SHEEN_SURFACE_SUBDIVISION_KNOWN_MODES_H
#define SHEEN_SURFACE_SUBDIVISION_KNOWN_MODES_H

#include "server/surface/subdivision/modes.h"

/* Rings of fewer faces take 0.3 ms. */
enum { KNOWN_MODES_MIN_FACES = 9 };

/* A list, empty: NULL; one for each number of faces. The sharp edge is the ring's first. */
struct known_modes {
    uint32_t n_faces;
    struct ring_modes modes;
    struct known_modes *older;
};

/* Adds those of a dart's ring of at most MODES_MAX_VALENCE faces, unless it has few, or they are
 * there, or memory is short. */
void known_modes_add(struct known_modes **list, const struct ring *ring, struct arena *arena);
void known_modes_finish(struct known_modes **list);

/* ring_modes_init(), but by the list where they are there. */
void known_modes_find(const struct known_modes *list, const struct ring *ring, struct arena *arena,
                      struct ring_modes *modes);

#endif
