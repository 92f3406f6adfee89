/* The edges of a cage by the faces that run along them. Internal to server/cage; any thread. */
#ifndef SHEEN_CAGE_EDGES_H
#define SHEEN_CAGE_EDGES_H

#include "server/cage/cage.h"

/* One side of an edge: the face corner where it leaves, and the face's next one. */
struct cage_half_edge {
    uint32_t high, corner, next; /* high: the edge's vertex of the larger index */
};

/* Sides by their lower vertex: side[start[v] .. start[v + 1]), sorted by the higher one. */
struct cage_edges {
    uint32_t *start;             /* [n_vertices + 2] */
    struct cage_half_edge *side; /* [corners] */
};

/* `cage` has passed cage_check(). n log n in its corners. False: no memory, nothing to finish. */
bool cage_edges_init(struct cage_edges *sides, const struct cage *cage);
void cage_edges_finish(struct cage_edges *sides);

/* Calls visit() for each edge with its n sides, by the lower vertex, then the higher one. */
void cage_each_edge(const struct cage_edges *sides, size_t n_vertices,
                    void (*visit)(void *context, uint32_t low, const struct cage_half_edge *side,
                                  size_t n),
                    void *context);

#endif
