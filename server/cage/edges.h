/* The edges of a cage, each with the half-edges of its faces. Internal to server/cage. Any
 * thread. */
#ifndef SHEEN_CAGE_EDGES_H
#define SHEEN_CAGE_EDGES_H

#include "server/cage/cage.h"

/* A half-edge: an edge as one of its faces traverses it, from the face's corner `corner` to corner
 * `next`. */
struct cage_half_edge {
    uint32_t high, corner, next; /* high: the larger vertex index of the two */
};

/* The half-edges, sorted by their lower vertex: those of vertex v are half_edge[start[v]] to
 * half_edge[start[v + 1] - 1], sorted by their higher vertex, so that those of one edge are
 * adjacent. */
struct cage_edges {
    uint32_t *start;                  /* [n_vertices + 2] */
    struct cage_half_edge *half_edge; /* [corners] */
};

/* `cage` has passed cage_check(). Takes n log n time in the number of corners. False: no memory;
 * there is then nothing to finish. */
bool cage_edges_init(struct cage_edges *edges, const struct cage *cage);
void cage_edges_finish(struct cage_edges *edges);

/* Calls visit() for each edge with its n half-edges, ordered by the lower vertex, then by the
 * higher one. */
void cage_each_edge(const struct cage_edges *edges, size_t n_vertices,
                    void (*visit)(void *context, uint32_t low,
                                  const struct cage_half_edge *half_edge, size_t n),
                    void *context);

#endif
