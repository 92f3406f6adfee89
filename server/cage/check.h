/* What cage_check() and cage_repair() (build/repair.h) both look for. Internal to server/cage;
 * any thread. */
#ifndef SHEEN_CAGE_CHECK_H
#define SHEEN_CAGE_CHECK_H

#include "server/cage/cage.h"

/* Says in is_edge[n_creases] which creases lie on an edge of some face: 1 or 0. Faces are in range;
 * the ends of creases may be any numbers. Linear in the size of the cage. False: no memory. */
bool cage_find_creases(const struct cage *cage, uint8_t *is_edge);

#endif
