/* The connectivity of a cage as half-edges, one for each corner of a face.
 *
 * Corner c of face f is also the half-edge from its vertex to the face's next vertex. Two faces
 * that traverse an edge in opposite directions are twins there. All other edges (boundary edges,
 * edges of three or more faces, edges that two faces traverse in the same direction) end a sector:
 * OpenSubdiv makes them infinitely sharp (far/topologyRefinerFactory.cpp). Nothing here depends on
 * the subdivision scheme. Built by topology.h; then read-only, for any thread. */
#ifndef SHEEN_SURFACE_TOPOLOGY_HALF_EDGES_H
#define SHEEN_SURFACE_TOPOLOGY_HALF_EDGES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/cage/cage.h"

#define CORNER_NONE UINT32_MAX

struct topology {
    const struct cage *cage;
    /* [corners]: the half-edge in the opposite direction, or CORNER_NONE. */
    uint32_t *twin;
    uint32_t *face;        /* [corners]: the face of the corner */
    uint8_t *vertex_flags; /* [vertices] */
    float *edge_sharpness; /* [corners], the same for twins; NULL: no creases in the cage */
    /* [corners]: sharpness of the half of the edge at the corner after one step by Chaikin's rule;
     * NULL: not Chaikin's rule, or no creases. */
    float *child_sharpness;
    float *vertex_sharpness;                /* [vertices]; NULL: no sharp vertices in the cage */
    struct nonmanifold_vertex *nonmanifold; /* [n_nonmanifold], sorted by vertex (nonmanifold.h) */
    struct vertex_creases *vertex_creases;  /* [n_vertex_creases] */
    size_t n_nonmanifold, n_vertex_creases;
    bool quads_only; /* all faces are quads */
};

enum {
    /* The surface passes through it: a corner of one face in mode EDGE_AND_CORNER, or
     * non-manifold. */
    VERTEX_SHARP = 1,
    /* At the end of an edge with one face that no crease makes infinitely sharp. */
    VERTEX_UNBOUND = 2,
    VERTEX_BY_NGON = 4, /* at a face that is not a quad */
    VERTEX_CREASED = 8, /* at the end of an interior edge with sharpness */
    VERTEX_TAGGED = 16, /* has sharpness of its own */
    /* Four faces, four edges, manifold; without any other flag a regular vertex. */
    VERTEX_PLAIN = 32,
    VERTEX_NON_MANIFOLD =
        64, /* its faces form several sheets, or one of its edges does not have two faces */
};

static inline uint32_t corner_vertex(const struct topology *t, uint32_t c)
{
    return t->cage->face_vertex[c];
}

static inline uint32_t face_size(const struct topology *t, uint32_t face)
{
    return t->cage->face_start[face + 1] - t->cage->face_start[face];
}

static inline uint32_t corner_next(const struct topology *t, uint32_t c)
{
    uint32_t face = t->face[c];
    return c + 1 == t->cage->face_start[face + 1] ? t->cage->face_start[face] : c + 1;
}

static inline uint32_t corner_prev(const struct topology *t, uint32_t c)
{
    uint32_t face = t->face[c];
    return c == t->cage->face_start[face] ? t->cage->face_start[face + 1] - 1 : c - 1;
}

/* The corner at the same vertex in the next face counter-clockwise, or CORNER_NONE. */
static inline uint32_t corner_ccw(const struct topology *t, uint32_t c)
{
    return t->twin[corner_prev(t, c)];
}

/* The corner at the same vertex in the next face clockwise, or CORNER_NONE. */
static inline uint32_t corner_cw(const struct topology *t, uint32_t c)
{
    uint32_t twin = t->twin[c];
    return twin == CORNER_NONE ? CORNER_NONE : corner_next(t, twin);
}

/* The sharpness of the edge of half-edge c; the ends of sectors are infinitely sharp. */
static inline float edge_sharpness(const struct topology *t, uint32_t c)
{
    if (t->twin[c] == CORNER_NONE)
        return CAGE_SHARPNESS_INFINITE;
    return t->edge_sharpness ? t->edge_sharpness[c] : 0;
}

/* The sharpness of the vertex at corner c. */
static inline float vertex_sharpness(const struct topology *t, uint32_t c)
{
    uint32_t v = t->cage->face_vertex[c];
    if (t->vertex_flags[v] & VERTEX_SHARP)
        return CAGE_SHARPNESS_INFINITE;
    return t->vertex_sharpness ? t->vertex_sharpness[v] : 0;
}

/* True if all four vertices of a quad, given by one of its corners, are interior and regular. */
static inline bool quad_is_plain(const struct topology *t, uint32_t c)
{
    for (int i = 0; i < 4; i++, c = corner_next(t, c))
        if (t->vertex_flags[corner_vertex(t, c)] != VERTEX_PLAIN)
            return false;
    return true;
}

/* The sector of a corner: the faces around the corner's vertex that are connected to it without
 * crossing the end of a sector. All corners of a sector get the same first face, so that sums over
 * the sector are equal to the last bit. */
struct sector {
    /* The most clockwise corner; in a closed sector the one with the lowest index. */
    uint32_t first;
    uint32_t n_faces; /* >= 1 */
    uint32_t at;      /* number of steps counter-clockwise from `first` to the given corner */
    bool closed;
};
struct sector topology_sector(const struct topology *t, uint32_t corner);

#endif
