/* The cage's connectivity as half-edges, one per face corner.
 *
 * Corner c of face f is also the half-edge from its vertex to the face's next vertex. Edges that
 * two faces share in opposite directions have twins; all others (boundary edges, edges of three
 * and more faces, edges that two faces run along in the same direction) end a sector, as
 * OpenSubdiv makes them infinitely sharp (far/topologyRefinerFactory.cpp). Nothing here is of one
 * subdivision scheme. Built by topology.h; read only afterwards, by any thread. */
#ifndef SHEEN_SURFACE_TOPOLOGY_HALF_EDGES_H
#define SHEEN_SURFACE_TOPOLOGY_HALF_EDGES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/cage/cage.h"

#define CORNER_NONE UINT32_MAX

struct topology {
    const struct cage *cage;
    uint32_t *twin;          /* [corners]: the half-edge the other way, or CORNER_NONE */
    uint32_t *face;          /* [corners]: the face it belongs to */
    uint8_t *vertex_flags;   /* [vertices] */
    float *edge_sharpness;   /* [corners], twins alike; NULL: no creases in the cage */
    float *child_sharpness;  /* [corners]: of the half at the corner after one step, by Chaikin's
                                rule; NULL: without that, or no creases */
    float *vertex_sharpness; /* [vertices]; NULL: no sharp vertices in the cage */
    struct nonmanifold_vertex *nonmanifold; /* [n_nonmanifold], by vertex: nonmanifold.h */
    struct vertex_creases *vertex_creases;  /* [n_vertex_creases] */
    size_t n_nonmanifold, n_vertex_creases;
    bool quads_only; /* all faces are quads */
};

enum {
    VERTEX_SHARP = 1, /* interpolated: a one-face corner in mode EDGE_AND_CORNER, or non-manifold */
    VERTEX_UNBOUND = 2, /* an edge of only one face ends here, not infinitely sharp by a crease */
    VERTEX_BY_NGON = 4, /* a face that is no quad touches it */
    VERTEX_CREASED = 8, /* an inner edge with sharpness ends here */
    VERTEX_TAGGED = 16, /* it has sharpness of its own */
    VERTEX_PLAIN = 32,  /* four faces, four edges, manifold. With no other flag: a regular vertex */
    VERTEX_NON_MANIFOLD =
        64, /* its faces form several sheets, or an edge of it is not of two faces */
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

/* The same clockwise. */
static inline uint32_t corner_cw(const struct topology *t, uint32_t c)
{
    uint32_t twin = t->twin[c];
    return twin == CORNER_NONE ? CORNER_NONE : corner_next(t, twin);
}

/* Sharpness of the edge of half-edge c; ends of sectors are infinitely sharp. */
static inline float edge_sharpness(const struct topology *t, uint32_t c)
{
    if (t->twin[c] == CORNER_NONE)
        return CAGE_SHARPNESS_INFINITE;
    return t->edge_sharpness ? t->edge_sharpness[c] : 0;
}

/* Sharpness of the vertex at corner c. */
static inline float vertex_sharpness(const struct topology *t, uint32_t c)
{
    uint32_t v = t->cage->face_vertex[c];
    if (t->vertex_flags[v] & VERTEX_SHARP)
        return CAGE_SHARPNESS_INFINITE;
    return t->vertex_sharpness ? t->vertex_sharpness[v] : 0;
}

/* Whether all four vertices of a quad, given by a corner, are interior and regular. */
static inline bool quad_is_plain(const struct topology *t, uint32_t c)
{
    for (int i = 0; i < 4; i++, c = corner_next(t, c))
        if (t->vertex_flags[corner_vertex(t, c)] != VERTEX_PLAIN)
            return false;
    return true;
}

/* The faces around a corner's vertex that are in the corner's sector. All corners of a sector get the same
 * first face, so that sums over the sector are equal to the last bit. */
struct sector {
    uint32_t first;   /* the clockwise-most corner; when closed, the one of lowest index */
    uint32_t n_faces; /* >= 1 */
    uint32_t at;      /* steps counter-clockwise from first to the given corner */
    bool closed;
};
struct sector topology_sector(const struct topology *t, uint32_t corner);

#endif
