/* Vertices at which several sheets of surface meet: pages along a spine, bodies that share an edge.
 *
 * Such a vertex has one rule for all its sheets, by the sharp edges of all of them together, or the
 * sheets would come apart (OpenSubdiv far/topologyRefinerFactory.cpp, vtr/refinement.cpp). What its
 * edges come to from step to step follows from their sharpness alone, so it is worked out once a
 * vertex, and the sheets' rings (ring.h) point to where they are in that list. */
#ifndef SHEEN_LIMIT_SHEETS_H
#define SHEEN_LIMIT_SHEETS_H

#include "server/limit/crease.h"
#include "server/limit/topology.h"

/* The sharp edges of a vertex, of all its sheets, after as many steps as there are levels before
 * this one. */
struct sheet_level {
    uint32_t n_sharp;            /* with those that end the sheets, each counted once */
    struct crease_sum semisharp; /* the semi-sharp among them; none: this level is the last */
};

struct vertex_sheets {
    uint32_t vertex;
    uint32_t end[2];      /* where the vertex is not sharp: the far ends of the two edges that end
                             its sheets, which are the crease through it */
    uint32_t first_level; /* in topology.sheet_level */
};

/* Lists the vertices of a topology that need it: those that are not sharp anyway, and with
 * Chaikin's rule those with creases, too. False: out of memory. The topology frees the list. */
bool sheets_init(struct topology *topology);

/* Of the vertex at corner c; NULL where it needs none. */
const struct vertex_sheets *sheets_at(const struct topology *topology, uint32_t corner);

#endif
