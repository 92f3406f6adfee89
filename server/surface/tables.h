/* The limit surface as tables, which devices draw and other code evaluates.
 *
 * Tables hold what Yasui and Kanai (2004) call P_i(n,k), the control points of every sub-patch.
 * They are computed in double precision, moved near zero, turned into a frame that keeps their
 * digits, divided by a power of two, and rounded to single precision once, at the end. README.md
 * explains this and why it is exact.
 *
 * There are two forms. Stored tables hold the points of every level, which devices copy to their
 * own memory: 10,000 bytes for each CORNER. Tables on demand hold what each node looks like as a
 * whole, and make the points of a level, the same bytes, from the cage when they are needed
 * (source.h): levels that no view reaches cost nothing.
 *
 * Builders (plan/surface_plan.h) compute the size of the tables and then fill any range of faces;
 * several threads may fill disjoint ranges. Filled tables are read-only, and any thread may read
 * them. */
#ifndef SHEEN_SURFACE_TABLES_H
#define SHEEN_SURFACE_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/surface/node.h"

struct limit_source; /* source.h */
struct record_cache; /* record_cache.h */

/* Support points (support.h) are searched with LIMIT_SUPPORT_STEPS steps along each side of a node.
 * One is kept for each cell on the sides of a cube about the model, LIMIT_SUPPORT_CELLS along each
 * edge of it. */
enum { LIMIT_SUPPORT_STEPS = 16, LIMIT_SUPPORT_CELLS = 16 };
#define LIMIT_MAX_SUPPORT (6 * LIMIT_SUPPORT_CELLS * LIMIT_SUPPORT_CELLS)

/* The size of a surface's tables, which a builder knows before it fills them. */
struct limit_size {
    size_t n_faces, n_nodes, n_texels, n_bounds;
    size_t count[LIMIT_KINDS];       /* number of nodes of each kind */
    double box_min[3], box_max[3];   /* box of the limit positions, which a camera frames */
    double hull_min[3], hull_max[3]; /* box of the control points, which contains the surface */
    struct limit_source *source;     /* owned by the plan */
    bool has_bends;                  /* the tables need `bends` */
    /* Main memory that the plan takes while it is made, with the model from which it is made, in
     * bytes: only for limit_may_need(); 0: little beside the tables. */
    size_t plan_bytes;
};

/* A node as a whole: for a CORNER its frame, a quaternion x y z w that turns frame coordinates into
 * world directions; and the surface's positions (world, relative to the node's origin) at local
 * (0,0) (1,0) (0,1) (1,1): the x of all four, then y, then z. */
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
    struct limit_head *heads;          /* [n_nodes]; unused for SPLIT and HOLE */
    /* [n_faces]: bit e: across edge e normals agree but curvatures do not, though `borders` says 0. NULL: at no edge of
     * the surface. */
    uint8_t *bends;
    struct limit_bound
        /* [n_nodes], about the node's origin: the bound of the node's own net, which is one step
         * coarser than the first level of a CORNER; radius -1: SPLIT, HOLE. */
        *whole;

    /* Stored tables only, else NULL. bound_first[node] is the index in `bounds` of the node's first
     * bound; there is one for each level of a CORNER or patch of a STRIP. The bound of a CORNER's
     * level also contains all that is nearer to the vertex. */
    size_t n_texels;
    float (*texels)[4];    /* [n_texels], see texels.h */
    uint32_t *bound_first; /* [n_nodes] */
    struct limit_bound *bounds;
    size_t n_bounds;
    /* Tables on demand only, else NULL. */
    struct limit_source *source; /* makes points */
    /* Cache of bounds that were asked for. */
    struct record_cache *level_bounds;

    double box_min[3], box_max[3]; /* as in limit_size */
    double hull_min[3], hull_max[3];
    /* Support points (support.h), relative to the middle of the box; NULL until they are found. */
    float (*support)[3];
    size_t n_support;

    size_t count[LIMIT_KINDS]; /* number of nodes of each kind, for `sheen info` */
};

/* Allocate tables of a size, without contents: stored or on demand. False with ERROR_SERVER, which
 * names the bytes, when memory is short; there is then nothing to finish. */
bool limit_tables_init(struct limit_tables *tables, const struct limit_size *size,
                       struct error *error);
bool limit_tables_init_on_demand(struct limit_tables *tables, const struct limit_size *size,
                                 struct error *error);
void limit_tables_finish(struct limit_tables *tables);

/* The bound of level n (from 1) of a CORNER or patch n of a STRIP, about the node's origin; for a
 * REGULAR node use `whole`. Any thread. */
struct limit_bound limit_level_bound(const struct limit_tables *tables, uint32_t node, unsigned n);
/* Call it between two frames, while no thread asks for bounds: bounds that the latest frames have
 * not asked for may be dropped. */
void limit_tables_turn(const struct limit_tables *tables);

/* Bytes of nodes, adjacency and, for stored tables, texels (a GPU has a copy of these), or, on
 * demand, heads and bounds of nodes. */
size_t limit_tables_bytes(const struct limit_tables *tables);
/* About how many levels of CORNERs and patches of STRIPs a view of the whole model reaches: no
 * corner of a face needs more than the first LIMIT_VIEW_LEVELS if the face's sides are 1,000 pixels
 * long. A closer view reaches more levels of fewer faces. Caches of points made on demand have room
 * for this many. */
enum { LIMIT_VIEW_LEVELS = 10 };
size_t limit_view_levels(const struct limit_tables *tables);
/* The largest number of support points. */
size_t limit_support_room(const struct limit_tables *tables);
/* The largest number of bytes that the tables take in main memory, from limit_tables_init() on,
 * with the support points and the source's memory. For tables that are only measured, which have no
 * source, without the latter. */
size_t limit_tables_host_bytes(const struct limit_tables *tables);
/* Of these, the bytes of a face that is one REGULAR node, or one CORNER node with the largest
 * number of levels. */
size_t limit_face_bytes(const struct limit_tables *tables, enum limit_kind kind);

#endif
