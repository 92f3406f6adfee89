/* Finds closed bodies whose faces turn inwards. Internal to server/cage/build; any thread. */
#ifndef SHEEN_CAGE_BUILD_BODIES_H
#define SHEEN_CAGE_BUILD_BODIES_H

#include "server/cage/cage.h"

/* Which faces of a cage are joined to bodies. */
struct bodies {
    const struct cage *cage;
    const uint32_t *body;   /* [n_faces]: one face of the body that each belongs to */
    const uint8_t *is_open; /* [n_faces], not 0 at a face whose body is not closed, or which is to
                               be left out */
};

/* Counts the closed bodies with a negative volume, and sets *first to the first face of the first
 * of them where there is any. A body whose box lies inside the box of one of the 16 closed bodies
 * with the largest positive volumes is taken for that one's hollow and not counted. Nor is a body
 * counted whose volume is no more than rounding: 1e-6 of the sum of its parts' magnitudes. Linear
 * in the number of corners. False: no memory. */
bool bodies_inside_out(const struct bodies *bodies, uint32_t *count, uint32_t *first);

#endif
