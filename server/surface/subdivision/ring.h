/* A vertex and the quads around it: its edges' far ends and the quads' opposite corners.
 *
 *   edge[k], face[k], edge[k+1] are the corners of quad k after the vertex, counter-clockwise.
 *   closed: n_faces edges, edge[n_faces] is edge[0]; open (a sector that ends at boundary or
 *   infinitely sharp edges): n_faces + 1 edges.
 *
 * Subdividing a ring needs nothing but itself (Catmull and Clark 1978; server/surface/README.md 3.1):
 * that is what makes every table a local computation.
 *
 * Memory is the caller's arena. No function here fails: arenas are sized before (arena.h).
 * Functions are pure but for that, so any thread may call them, with an arena of its own. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_H
#define SHEEN_SURFACE_SUBDIVISION_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/surface/subdivision/arena.h"
#include "server/surface/vec.h"

/* Crease sharpness of the edges around a vertex (server/surface/subdivision/crease.h). */
struct ring_creases {
    float *edge; /* [edges]: of each edge */
    float *far;  /* [edges]: after one step, the sharpness of the half of edge k that lies away
                    from the vertex */
    bool chaikin;
};

/* What the vertex has beside this sheet, where several meet
 * (server/surface/topology/nonmanifold.h).
 */
struct ring_sheets {
    /* The vertex's sharp edges at the ring's own level of refinement. NULL: the vertex has no other
     * sheet; after ring_settle() also: the others matter no more, since the vertex is sharp or
     * the crease through it ends this sheet. */
    const struct vertex_creases *creases;
    struct vec end[2]; /* the far ends of the crease through the vertex, which ends its sheets */
    bool ends_outside; /* it does not end this one, which is closed or has one edge as both ends */
};

struct ring {
    uint32_t n_faces; /* valence of a closed ring */
    uint32_t at;      /* index in the ring of the quad whose table is being made */
    bool closed;
    bool cut_extraordinary;      /* a sector of a vertex that is extraordinary as a whole */
    float sharpness;             /* of the vertex; CAGE_SHARPNESS_INFINITE: the limit surface
                                    passes through it */
    struct ring_creases creases; /* edge is NULL: smooth, but for the ends of an open ring */
    struct ring_sheets sheets;
    struct vec centre;
    struct vec *edge;           /* [n_faces + !closed] */
    struct vec *face;           /* [n_faces] */
    struct cached_ring *cached; /* where the ring is kept (ring_cache.h); NULL: nowhere */
};

/* A smooth ring with room for its points; with_creases: and for sharpness, all zero. */
struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed, bool with_creases);
/* Bytes of arena that such a ring takes at most. */
size_t ring_bytes(size_t n_faces, bool with_creases);

static inline uint32_t ring_edges(const struct ring *ring)
{
    return ring->n_faces + !ring->closed;
}

/* Whether a settled ring (settle.h) is of a crease that does not end it: a sheet closed by itself,
 * or between two sides of the same edge, at a vertex where other sheets have the crease. */
static inline bool ring_has_foreign_crease(const struct ring *settled)
{
    return settled->sheets.creases;
}

/* Edge and face by steps from the quad at ring->at: edge(0) is the quad's next corner, edge(1) its
 * previous one. For open rings the step must stay inside the sector. */
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

/* Whether there is a quad that many steps from ring->at. */
static inline bool ring_has_face(const struct ring *ring, int step)
{
    int64_t k = (int64_t)ring->at + step;
    return ring->closed || (k >= 0 && k < ring->n_faces);
}

#endif
