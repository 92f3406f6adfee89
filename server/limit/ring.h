/* A vertex and the quads around it: its edges' far ends and the quads' opposite corners.
 *
 *   edge[k], face[k], edge[k+1] are the corners of quad k after the vertex, counter-clockwise.
 *   closed: n_faces edges, edge[n_faces] is edge[0]; open (a sector that ends at boundary or
 *   infinitely sharp edges): n_faces + 1 edges.
 *
 * Subdividing a ring needs nothing but itself (Catmull and Clark 1978; limit-surface 4.2, 4.5):
 * that is what makes every table a local computation. Memory is the caller's arena. */
#ifndef SHEEN_LIMIT_RING_H
#define SHEEN_LIMIT_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/limit/vec.h"

struct ring {
    uint32_t n_faces; /* valence of a closed ring */
    uint32_t at;      /* which quad of the ring is the one that it is looked at from */
    bool closed;
    bool sharp; /* the vertex is interpolated */
    struct vec centre;
    struct vec *edge; /* [n_faces + !closed] */
    struct vec *face; /* [n_faces] */
};

/* A bump allocator, reset between faces: rings live only while one face is built. */
struct arena {
    struct vec *memory;
    size_t used, capacity; /* in vecs */
};
bool arena_init(struct arena *arena, size_t capacity);
void arena_finish(struct arena *arena);
/* Never fails: plans size the arena beforehand (see quad.h). */
struct vec *arena_take(struct arena *arena, size_t n);
/* An empty ring with room for its points. */
struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed);

static inline uint32_t ring_edges(const struct ring *ring)
{
    return ring->n_faces + !ring->closed;
}

/* Edge and face by steps from the quad at ring->at: edge(0) is the quad's next corner, edge(1) its
 * previous one. For open rings the step must stay inside the sector. */
static inline struct vec ring_edge(const struct ring *ring, int step)
{
    int64_t k = (int64_t)ring->at + step, n = ring_edges(ring);
    return ring->edge[((k % n) + n) % n];
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

/* Regular: its quads are plain B-spline patches (with phantom points beyond a sector's end). */
static inline bool ring_is_regular(const struct ring *ring)
{
    uint32_t regular = ring->closed ? 4 : ring->sharp ? 1 : 2;
    return ring->n_faces == regular && !(ring->closed && ring->sharp);
}

/* One Catmull-Clark step: `out` has room for as many points and gets the rest of `in`'s fields.
 * in and out may not share memory. */
void ring_refine(const struct ring *in, struct ring *out);

/* Where the vertex lies on the limit surface. */
struct vec ring_limit(const struct ring *ring);

/* A right-handed orthonormal frame at the limit position: axis[2] is the limit normal along the
 * winding. A sharp ring of several quads has no one normal; the frame then only is some frame, as
 * it is when the points coincide. */
void ring_frame(const struct ring *ring, struct vec axis[3]);

#endif
