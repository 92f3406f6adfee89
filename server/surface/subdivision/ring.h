/* A ring: a vertex and the quads around it, given by the far ends of its edges and the opposite
 * corners of the quads.
 *
 *   edge[k], face[k], edge[k+1] are the corners of quad k after the vertex, counter-clockwise.
 *   closed: n_faces edges, edge[n_faces] is edge[0]; open (a sector that ends at boundary or
 *   infinitely sharp edges): n_faces + 1 edges.
 *
 * One subdivision step of a ring depends only on the ring (Catmull and Clark 1978;
 * server/surface/README.md 3.1), so every table is a local computation.
 *
 * Points are in any coordinates. Memory comes from the caller's arena. No function here can fail:
 * arenas are large enough (arena.h). Any thread, each with its own arena. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_H
#define SHEEN_SURFACE_SUBDIVISION_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/arena.h"
#include "server/surface/vec.h"

/* Crease sharpness of the edges around a vertex (crease.h). */
struct ring_creases {
    float *edge; /* [edges]: sharpness of each edge */
    float *far;  /* [edges]: sharpness after one step of the far half of edge k */
    bool chaikin;
};

/* A ring is one sheet of surface. If several sheets meet at the vertex
 * (server/surface/topology/nonmanifold.h), this is what the ring must know of the others. */
struct ring_sheets {
    /* The vertex's sharp edges, of all sheets, at the ring's level of refinement. NULL if the
     * vertex has no other sheet; after ring_settle() also NULL if the other sheets have no more
     * influence, because the vertex is sharp or the crease through it ends this sheet. */
    const struct vertex_creases *creases;
    struct vec end[2]; /* the far ends of the crease through the vertex, which ends its sheets */
    /* That crease does not end this sheet: the sheet is closed, or begins and ends at one edge. */
    bool crease_is_outside;
};

struct ring {
    uint32_t n_faces; /* closed ring: the valence */
    uint32_t at;      /* index in the ring of the quad whose table is made */
    bool closed;
    bool cut_extraordinary; /* a sector of an extraordinary vertex */
    /* Of the vertex; CAGE_SHARPNESS_INFINITE: the surface passes through it. */
    float sharpness;
    struct ring_creases
        creases; /* edge is NULL: all edges are smooth, except an open ring's ends */
    struct ring_sheets sheets;
    struct vec centre;          /* the vertex */
    struct vec *edge;           /* [n_faces + !closed] */
    struct vec *face;           /* [n_faces] */
    struct cached_ring *cached; /* entry of the ring cache (ring_cache.h); NULL: none */
};

/* Takes a smooth ring from the arena, with room for its points, which are not set, and,
 * with_creases, for sharpness, all zero. */
struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed, bool with_creases);
/* An upper bound of the arena bytes of such a ring. */
size_t ring_bytes(size_t n_faces, bool with_creases);

/* The number of edges. */
static inline uint32_t ring_edges(const struct ring *ring)
{
    return ring->n_faces + !ring->closed;
}

/* True if the vertex of a settled ring (settle.h) lies on a crease of other sheets, which does not
 * end this one. */
static inline bool ring_has_outside_crease(const struct ring *settled)
{
    return settled->sheets.creases;
}

/* Edges and faces, counted in steps counter-clockwise from the quad at ring->at: edge 0 goes to the
 * quad's next corner, edge 1 to its previous one, face 0 is its opposite corner. In open rings the
 * step must stay inside the sector. */
static inline uint32_t ring_edge_index(const struct ring *ring, int step)
{
    int64_t k = (int64_t)ring->at + step, n = ring_edges(ring);
    return (uint32_t)(((k % n) + n) % n);
}

static inline struct vec ring_edge(const struct ring *ring, int step)
{
    return ring->edge[ring_edge_index(ring, step)];
}

static inline struct vec ring_face(const struct ring *ring, int step)
{
    int64_t k = (int64_t)ring->at + step, n = ring->n_faces;
    return ring->face[((k % n) + n) % n];
}

/* True if there is a quad this many steps from ring->at. */
static inline bool ring_has_face(const struct ring *ring, int step)
{
    int64_t k = (int64_t)ring->at + step;
    return ring->closed || (k >= 0 && k < ring->n_faces);
}

#endif
