/* Non-manifold vertices, at which several sheets of surface meet: pages along a spine, bodies that
 * share an edge.
 *
 * Such a vertex has one rule for all its sheets, by the sharp edges of all of them together;
 * otherwise the sheets would separate (OpenSubdiv far/topologyRefinerFactory.cpp,
 * vtr/refinement.cpp). The sharpness of its edges after each subdivision step depends only on their
 * sharpness. So it is computed once for a vertex, as a list with one entry for each step, and the
 * rings of the vertex's sheets (ring.h) point to the entry of their step.
 *
 * Thread: the lists are read-only after nonmanifold_find(). */
#ifndef SHEEN_SURFACE_TOPOLOGY_NONMANIFOLD_H
#define SHEEN_SURFACE_TOPOLOGY_NONMANIFOLD_H

#include "server/surface/topology/half_edges.h"
#include "server/surface/topology/sharpness.h"

/* The sharp edges of a vertex, of all its sheets together, after a number of subdivision steps: 0
 * for the first entry of a vertex, one more for each next entry. */
struct vertex_creases {
    /* Number of sharp edges; each edge that ends sheets counts once. */
    uint32_t n_sharp;
    struct sharpness_sum semisharp; /* the semi-sharp ones among them; n = 0: the last entry */
};

struct nonmanifold_vertex {
    uint32_t vertex;
    /* Vertices: the far ends of the first two different edges that end its sheets. If the vertex is
     * not sharp, there are no other such edges, and these two are the crease through it. If there
     * are fewer than two such edges, the vertex itself stands for the missing ones. */
    uint32_t end[2];
    uint32_t first_step; /* index of its first entry in topology.vertex_creases */
};

/* Fills in topology.nonmanifold and topology.vertex_creases for the non-manifold vertices that need
 * it: those that are not sharp anyway and, under Chaikin's rule, also those with creases. False:
 * memory is short, and the two arrays are incomplete. The topology owns and frees them in both
 * cases. */
bool nonmanifold_find(struct topology *topology);

/* The entry of the vertex at corner c; NULL if it has none. */
const struct nonmanifold_vertex *nonmanifold_at(const struct topology *topology, uint32_t corner);

#endif
