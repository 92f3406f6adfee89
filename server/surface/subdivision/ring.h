/* A vertex and the quads around it: its edges' far ends and the quads' opposite corners.
 *
 *   edge[k], face[k], edge[k+1] are the corners of quad k after the vertex, counter-clockwise.
 *   closed: n_faces edges, edge[n_faces] is edge[0]; open (a sector that ends at boundary or
 *   infinitely sharp edges): n_faces + 1 edges.
 *
 * One step of subdivision of a ring needs nothing but the ring (Catmull and Clark 1978;
 * server/surface/README.md 3.1). Therefore every table is a local computation.
 *
 * Points are in any coordinates. Memory is the caller's arena. No function here fails: arenas are
 * sized beforehand (arena.h). Any thread, each with an arena of its own. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_H
#define SHEEN_SURFACE_SUBDIVISION_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/arena.h"
#include "server/surface/vec.h"

/* Crease sharpness of the edges around a vertex (crease.h). */
struct ring_creases {
    float *edge; /* [edges]: of each edge */
    float *
        far; /* [edges]: what the half of edge k that lies away from the vertex has after one step */
    bool chaikin;
};

/* A ring is one sheet of surface. Where several sheets meet at the vertex
 * (server/surface/topology/nonmanifold.h), this is what the ring must know of the others. */
struct ring_sheets {
    /* The vertex's sharp edges, of all sheets, at the ring's own level of refinement. NULL where the
     * vertex has no other sheet. After ring_settle() NULL also where the other sheets have no more
     * influence: the vertex is sharp, or the crease through it ends this sheet. */
    const struct vertex_creases *creases;
    struct vec end[2]; /* the far ends of the crease through the vertex, which ends its sheets */
    /* That crease does not end this sheet: it is closed, or begins and ends at one edge. */
    bool crease_is_outside;
};

struct ring {
    uint32_t n_faces; /* of a closed ring the valence */
    uint32_t at;      /* index in the ring of the quad whose table is being made */
    bool closed;
    bool cut_extraordinary; /* a sector of a vertex that as a whole is extraordinary */
    float sharpness;        /* of the vertex; CAGE_SHARPNESS_INFINITE: the limit surface
                                    passes through it */
    struct ring_creases
        creases; /* edge is NULL: all edges are smooth, but for an open ring's ends */
    struct ring_sheets sheets;
    struct vec centre;          /* the vertex */
    struct vec *edge;           /* [n_faces + !closed] */
    struct vec *face;           /* [n_faces] */
    struct cached_ring *cached; /* where the ring is kept (ring_cache.h); NULL: nowhere */
};

/* A smooth ring with room for its points, which are not set. with_creases: also with room for
 * sharpness, all zero. */
struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed, bool with_creases);
/* Bytes of arena that such a ring takes at most. */
size_t ring_bytes(size_t n_faces, bool with_creases);

/* How many edges it has. */
static inline uint32_t ring_edges(const struct ring *ring)
{
    return ring->n_faces + !ring->closed;
}

/* Whether the vertex of a settled ring (settle.h) lies on a crease of other sheets, which does not end
 * this one. */
static inline bool ring_has_outside_crease(const struct ring *settled)
{
    return settled->sheets.creases;
}

/* Edges and faces by steps from the quad at ring->at, counter-clockwise: edge 0 goes to the quad's next
 * corner, edge 1 to its previous one, face 0 is its opposite corner. In open rings the step must stay
 * inside the sector. */
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
