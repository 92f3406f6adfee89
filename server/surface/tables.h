/* The limit surface as tables: what devices draw, and what everything else here evaluates.
 *
 * They hold what Yasui and Kanai (2004) call P_i(n,k), the control points of every sub-patch, exact
 * in single precision: computed in double, moved near zero, turned into a frame that keeps their
 * digits, divided by a power of two and rounded once at the end. README.md says how, and why that
 * is exact.
 *
 * Builders (subdivision/build.h) say how large the tables are, and fill any range of faces: several
 * threads may fill disjoint ranges. Once filled they are read only and any thread may read them. */
#ifndef SHEEN_SURFACE_TABLES_H
#define SHEEN_SURFACE_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/surface/node.h"

/* How far a piece of surface reaches and bends, in units: for culling, and to choose the grid that
 * it is drawn with. Cut into m x n cells the piece lies within (u / m^2 + 2 mixed / (m n) + v /
 * n^2) / 8 of their triangles, and a curve on it along u or v, as its borders are, within border_u
 * / (8 m^2) or border_v / (8 n^2) (README.md 6.1). */
struct limit_bound {
    float radius; /* of a sphere about the piece's origin that holds its control points */
    float u, mixed, v;
    float border_u, border_v;
};

/* Points of the surface that lie outermost (support.h) are looked for at so many steps along each
 * side of a node, and one is kept for each cell of a cube about the model, of so many cells along a
 * side. */
enum { LIMIT_SUPPORT_STEPS = 16, LIMIT_SUPPORT_CELLS = 16 };
#define LIMIT_MAX_SUPPORT (6 * LIMIT_SUPPORT_CELLS * LIMIT_SUPPORT_CELLS)

/* What a builder knows of a surface before any of it is filled in. */
struct limit_size {
    size_t n_faces, n_nodes, n_texels, n_bounds;
    size_t count[LIMIT_KINDS]; /* of nodes, by kind */
    double box_min[3],
        box_max[3]; /* about the surface, by its limit positions: what a camera frames */
    double hull_min[3], hull_max[3]; /* about the control points: nothing lies outside */
};

struct limit_tables {
    size_t n_faces;
    size_t n_nodes;
    struct limit_node *nodes;          /* [n_nodes]; node f is the root of face f */
    struct limit_adjacency *adjacency; /* [n_faces] */
    size_t n_texels;
    float (*texels)[4]; /* [n_texels], see texels.h */

    /* For the processor's choice of grids; not on the GPU. bound_first[node] indexes bounds, and
     * the first of a node's bounds holds all of it: one for REGULAR, one for each level of a
     * CORNER, one for the whole of a STRIP and one for each of its patches; none for SPLIT and
     * HOLE. Of a CORNER's levels each also holds all that lies nearer to the vertex. About the
     * node's origin. */
    uint32_t *bound_first; /* [n_nodes] */
    struct limit_bound *bounds;
    size_t n_bounds;

    double box_min[3], box_max[3]; /* as in limit_size */
    double hull_min[3], hull_max[3];
    /* Points of the surface that lie outermost, from the middle of the box (support.h); NULL until
     * they are looked for. */
    float (*support)[3];
    size_t n_support;

    size_t count[LIMIT_KINDS]; /* of nodes, by kind: for `sheen info` */
};

/* Allocates tables of a size, without contents. ERROR_SERVER, which names the bytes, when there is
 * no memory; there is nothing to finish then. */
bool limit_tables_init(struct limit_tables *tables, const struct limit_size *size,
                       struct error *error);
void limit_tables_finish(struct limit_tables *tables);

/* Bytes that the GPU holds for these tables: nodes, adjacency and texels. */
size_t limit_tables_bytes(const struct limit_tables *tables);
/* How many support points there may be. */
size_t limit_support_room(const struct limit_tables *tables);
/* Bytes that they take in main memory from limit_tables_init() on: the same, the bounds, and room
 * for the support points. */
size_t limit_tables_host_bytes(const struct limit_tables *tables);
/* Bytes that the GPU holds for a face of one REGULAR node, or of one CORNER node with as many
 * levels as there can be. */
size_t limit_face_bytes(enum limit_kind kind);

#endif
