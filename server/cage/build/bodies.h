/* Finds closed bodies whose normals point inwards. Internal to server/cage/build. Any thread. */
#ifndef SHEEN_CAGE_BUILD_BODIES_H
#define SHEEN_CAGE_BUILD_BODIES_H

#include "server/cage/cage.h"

/* The partition of a cage's faces into bodies. */
struct bodies {
    const struct cage *cage;
    const uint32_t *body; /* [n_faces]: for each face, one face of its body */
    /* [n_faces], not 0 for a face whose body is not closed, or is to be left out. */
    const uint8_t *is_open;
};

/* Counts the closed bodies with a negative volume, and sets *first to the first face of the first
 * of them, if there is one. Not counted: a body whose box lies inside the box of one of the 16
 * closed bodies with the largest positive volumes, because it is probably that body's hollow; and a
 * body whose volume may be rounding, at most 1e-6 of the sum of its parts' magnitudes. Linear in
 * the number of corners. False: no memory. */
bool bodies_inside_out(const struct bodies *bodies, uint32_t *count, uint32_t *first);

#endif
