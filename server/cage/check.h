/* What cage_check() and cage_repair() (build/repair.h) have in common. Internal to server/cage. Any
 * thread. */
#ifndef SHEEN_CAGE_CHECK_H
#define SHEEN_CAGE_CHECK_H

#include "server/cage/cage.h"

/* Sets is_edge[n_creases]: 1 if the crease lies on an edge of a face, else 0. The indices of faces
 * must be in range; those of creases may be any numbers. Linear in the size of the cage. False: no
 * memory. */
bool cage_find_creases(const struct cage *cage, uint8_t *is_edge);

#endif
