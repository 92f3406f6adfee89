/* The edges of a cage, each with the half-edges of the faces that run along it. Internal to
 * server/cage; any thread. */
#ifndef SHEEN_CAGE_EDGES_H
#define SHEEN_CAGE_EDGES_H

#include "server/cage/cage.h"

/* An edge as one of its faces runs along it: from corner `corner` of the face to `next`. */
struct cage_half_edge {
    uint32_t high, corner, next; /* high: the vertex of larger index of the two */
};

/* Half-edges by their lower vertex: half_edge[start[v] .. start[v + 1]), sorted by the higher
 * one, so that those of one edge stand together. */
struct cage_edges {
    uint32_t *start;                  /* [n_vertices + 2] */
    struct cage_half_edge *half_edge; /* [corners] */
};

/* `cage` has passed cage_check(). n log n in its corners. False: no memory, nothing to finish. */
bool cage_edges_init(struct cage_edges *edges, const struct cage *cage);
void cage_edges_finish(struct cage_edges *edges);

/* Calls visit() for each edge with its n half-edges, in the order of the lower vertex, then of
 * the higher one. */
void cage_each_edge(const struct cage_edges *edges, size_t n_vertices,
                    void (*visit)(void *context, uint32_t low,
                                  const struct cage_half_edge *half_edge, size_t n),
                    void *context);

#endif
