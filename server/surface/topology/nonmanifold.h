/* Vertices at which several sheets of surface meet: pages along a spine, bodies that share an edge.
 *
 * Such a vertex has one rule for all its sheets, by the sharp edges of all of them together, or the
 * sheets would come apart (OpenSubdiv far/topologyRefinerFactory.cpp, vtr/refinement.cpp). The
 * sharpness left of its edges after each subdivision step follows from their sharpness alone. It is
 * therefore computed once for a vertex, as a list with an entry for each step, and the rings of the
 * vertex's sheets (ring.h) point to the entry for their own step.
 *
 * Thread: the lists are read only once nonmanifold_find() has made them. */
#ifndef SHEEN_SURFACE_TOPOLOGY_NONMANIFOLD_H
#define SHEEN_SURFACE_TOPOLOGY_NONMANIFOLD_H

#include "server/surface/topology/half_edges.h"
#include "server/surface/topology/sharpness.h"

/* The sharp edges of a vertex, of all its sheets together, after some number of subdivision steps. The
 * first entry of a vertex is for no step, each next one for one step more. */
struct vertex_creases {
    uint32_t n_sharp;               /* edges; those that end sheets are counted once each */
    struct sharpness_sum semisharp; /* the semi-sharp among them; n = 0: this entry is the last */
};

struct nonmanifold_vertex {
    uint32_t vertex;
    uint32_t end[2];     /* vertices: the far ends of the first two different edges that end its
                            sheets. Where the vertex is not sharp there are no others, and the two
                            edges are the crease through it. Where fewer than two edges end its
                            sheets, the vertex itself takes the place of the missing ones */
    uint32_t first_step; /* index in topology.vertex_creases of its first entry */
};

/* Fills topology.nonmanifold and topology.vertex_creases with the non-manifold vertices that need it:
 * those that are not sharp anyway, and under Chaikin's rule also those with creases. False: memory
 * is short, and the two arrays are incomplete. The topology owns and frees them in both cases. */
bool nonmanifold_find(struct topology *topology);

/* The entry of the vertex at corner c; NULL where it has none. */
const struct nonmanifold_vertex *nonmanifold_at(const struct topology *topology, uint32_t corner);

#endif
