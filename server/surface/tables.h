/* The limit surface as tables: what devices draw, and what everything else here evaluates.
 *
 * They hold what Yasui and Kanai (2004) call P_i(n,k), the control points of every sub-patch, exact
 * in single precision: computed in double, moved near zero, turned into a frame that keeps their
 * digits, divided by a power of two and rounded once at the end. README.md says how, and why that
 * is exact.
 *
 * There are two forms. Stored tables hold the points of every level, as devices copy them to their own
 * memory: 10,000 bytes for each CORNER. Tables on demand hold what each node looks like as a whole, and
 * make the points of a level where they are asked for, from the cage, the same bytes (source.h): a
 * thousand levels that no view reaches cost nothing.
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

struct limit_source; /* source.h */
struct record_cache; /* record_cache.h */

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
    struct limit_source *source;     /* the plan's */
};

/* What a node looks like as a whole, from its origin: its frame as a quaternion x y z w, which turns the
 * frame's coordinates into world directions (of a CORNER); then x, y and z, world, of the surface at
 * its corners: local (0,0) (1,0) (0,1) (1,1). */
struct limit_head {
    float frame[4];
    float corner[3][4];
};

struct limit_tables {
    bool on_demand;
    size_t n_faces;
    size_t n_nodes;
    struct limit_node *nodes;          /* [n_nodes]; node f is the root of face f */
    struct limit_adjacency *adjacency; /* [n_faces] */
    struct limit_head *heads;          /* [n_nodes]; nothing of SPLIT and HOLE */
    struct limit_bound
        *whole; /* [n_nodes], about the node's origin: of the node's own net, one step
                                     coarser than a CORNER's first level; radius -1: SPLIT, HOLE */

    /* Of stored tables; NULL: on demand. bound_first[node] indexes bounds, which are one for each
     * level of a CORNER or patch of a STRIP. Of a CORNER's levels each also holds all that lies nearer to
     * the vertex. */
    size_t n_texels;
    float (*texels)[4];    /* [n_texels], see texels.h */
    uint32_t *bound_first; /* [n_nodes] */
    struct limit_bound *bounds;
    size_t n_bounds;
    /* Of tables on demand; NULL: stored. */
    struct limit_source *source; /* makes points */
    /* Bounds that have been asked for. */
    struct record_cache *level_bounds;

    double box_min[3], box_max[3]; /* as in limit_size */
    double hull_min[3], hull_max[3];
    /* Points of the surface that lie outermost, from the middle of the box (support.h); NULL until
     * they are looked for. */
    float (*support)[3];
    size_t n_support;

    size_t count[LIMIT_KINDS]; /* of nodes, by kind: for `sheen info` */
};

/* Allocates tables of a size, without contents: stored ones, or on demand. ERROR_SERVER, which names
 * the bytes, when there is no memory; there is nothing to finish then. */
bool limit_tables_init(struct limit_tables *tables, const struct limit_size *size,
                       struct error *error);
bool limit_tables_init_on_demand(struct limit_tables *tables, const struct limit_size *size,
                                 struct error *error);
void limit_tables_finish(struct limit_tables *tables);

/* How far level n (from 1) of a CORNER or patch n of a STRIP reaches and bends, about the node's origin;
 * of a REGULAR node `whole` says it. Any thread. */
struct limit_bound limit_level_bound(const struct limit_tables *tables, uint32_t node, unsigned n);
/* Between two frames, when nobody else asks for bounds: bounds that none of the last frames has
 * asked for may be dropped. */
void limit_tables_turn(const struct limit_tables *tables);

/* Bytes of nodes, adjacency and what both forms have of points: stored tables' texels, which a GPU holds a
 * copy of, or heads and bounds of nodes. */
size_t limit_tables_bytes(const struct limit_tables *tables);
/* How many levels of CORNERs and patches of STRIPs a view of the whole model reaches, about: no corner
 * of a face takes more than the first LIMIT_VIEW_LEVELS, where 1,000 pixels lie along its sides. A view from
 * nearer reaches more levels of fewer faces. Caches of what is made on demand have room for so many. */
enum { LIMIT_VIEW_LEVELS = 10 };
size_t limit_view_levels(const struct limit_tables *tables);
/* How many support points there may be. */
size_t limit_support_room(const struct limit_tables *tables);
/* Bytes that they take in main memory from limit_tables_init() on, at most, with room for the support
 * points and with what their source holds. Of tables that are still measured, without a source: without
 * that. */
size_t limit_tables_host_bytes(const struct limit_tables *tables);
/* Of that, bytes of a face of one REGULAR node, or of one CORNER node with as many levels as there can
 * be. */
size_t limit_face_bytes(const struct limit_tables *tables, enum limit_kind kind);

#endif
