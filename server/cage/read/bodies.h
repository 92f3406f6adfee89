/* Closed bodies whose faces turn inwards. Internal to server/cage/read; any thread. */
#ifndef SHEEN_CAGE_READ_BODIES_H
#define SHEEN_CAGE_READ_BODIES_H

#include "server/cage/cage.h"

/* The bodies of a cage. */
struct bodies {
    const struct cage *cage;
    const uint32_t *body;   /* [n_faces]: one face of the body that each belongs to */
    const uint8_t *is_open; /* [n_faces], not 0 at a face whose body is not closed, or which is to
                               be left out */
};

/* Counts the closed bodies with a negative volume and sets *first to the first face of the first.
 * One that lies inside another closed body is that one's hollow and does not count, as far as the
 * others are among the largest. Linear. False: no memory. */
bool bodies_inside_out(const struct bodies *bodies, uint32_t *count, uint32_t *first);

#endif
