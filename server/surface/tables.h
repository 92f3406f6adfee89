/* The limit surface of a cage as the tables that the GPU reads: what Yasui and Kanai (2004) call
 * P_i(n,k), kept exact in single precision.
 *
 * The surface is a list of nodes. The first n_faces nodes are the Ptex faces' roots (OpenSubdiv's
 * numbering: a quad is one Ptex face, an n-gon is n). A node is
 *   REGULAR  one bicubic B-spline patch of 16 points i,j = -1..2;
 *   CORNER   one extraordinary vertex at local (0,0): levels of 24 points in the vertex's own
 *            orthonormal frame, each re-centred on the vertex's limit position (corner.h);
 *   STRIP    a semi-sharp crease along local v = 0: `levels` + 1 patches across it (strip.h);
 *   SPLIT    four children at (0,0) (1,0) (1,1) (0,1) of the half-size cells;
 *   HOLE     no surface (a hole, or boundary mode NONE).
 * Points are relative to the node's origin. Those of a patch or level are divided by a power of
 * two, their scale. How they lie in texels of four floats is said in texels.h.
 *
 * Built in two steps so that callers may use threads (this module knows none): limit_plan() reads
 * the cage and sizes everything; limit_build_faces() fills any range of faces, ranges in parallel
 * as long as they do not overlap. All arithmetic is double; tables are rounded once at the end. */
#ifndef SHEEN_SURFACE_TABLES_H
#define SHEEN_SURFACE_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/cage/cage.h"
#include "server/base/error.h"

/* Dyadic rings towards an extraordinary vertex: as many as leave out less than a pixel where pixels
 * are 2^-24 of the face, and never fewer than the least (corner.h). */
#define LIMIT_MIN_LEVELS 32
#define LIMIT_MAX_LEVELS 41
#define LIMIT_PATCH_TEXELS 13                              /* the scale; 4 rows of 4 points */
#define LIMIT_CORNER_HEAD(levels) (1 + ((levels) + 3) / 4) /* the frame; the levels' scales */
#define LIMIT_LEVEL_TEXELS 18                              /* 5 rows and a column of 4 points */
#define LIMIT_CORNER_TEXELS(levels) (LIMIT_CORNER_HEAD(levels) + (levels)*LIMIT_LEVEL_TEXELS)
#define LIMIT_NO_NORMAL 0x80u /* added to a CORNER's levels */
#define LIMIT_NO_FACE UINT32_MAX
/* Building holds dozens of rings at once (plan.c). */
#define LIMIT_MAX_VALENCE 4096

enum limit_kind { LIMIT_REGULAR, LIMIT_CORNER, LIMIT_SPLIT, LIMIT_HOLE, LIMIT_STRIP };

/* 48 bytes, three RGBA32UI texels on the GPU. */
struct limit_node {
    double origin[3];     /* world; the points are relative to it */
    uint32_t first;       /* all with points: first of its texels; SPLIT: first of 4 children */
    uint32_t face;        /* Ptex face */
    uint32_t cell;        /* x | y << 16: which cell of the 2^depth by 2^depth grid over the face */
    uint8_t kind;         /* enum limit_kind */
    uint8_t depth;        /* the node spans 2^-depth of its Ptex face */
    uint8_t rotation;     /* local (0,0) is this corner 0..3 of the cell */
    uint8_t levels;       /* STRIP: patches but one; CORNER: its levels, plus LIMIT_NO_NORMAL at a
                             cone's tip */
    uint32_t ngon_size;   /* of a root: corners of its n-gon, 0 for a quad */
    uint16_t ngon_corner; /* and which of them is this Ptex face's corner 0 */
    uint16_t borders;     /* of the Ptex face: four bits an edge, LIMIT_BORDER_... */
};

/* Along an edge of a Ptex face the surface may end, or have a crease: 0 where it has neither, else
 * the levels that the crease takes (it is rounded over 2^-levels of the face), LIMIT_BORDER_SHARP
 * where the surface ends or the crease is infinitely sharp. Edge e has the bits from 4 e on. */
#define LIMIT_BORDER_SHARP 15u

/* What lies across edge e (corner e to corner e + 1) of a Ptex face: face << 2 | its edge there,
 * or LIMIT_NO_FACE. The quad beside an n-gon borders two of its Ptex faces: the one named is at the
 * end of edge e, the next one of the n-gon (by ngon_corner) at its start. 16 bytes, one RGBA32UI
 * texel. */
struct limit_adjacency {
    uint32_t across[4];
};

/* How far a piece of surface reaches and bends: for culling and for choosing its grid. In units.
 * Cut into m x n cells it lies within (u / m^2 + 2 mixed / (m n) + v / n^2) / 8 of their triangles
 * (limit-surface 3.2: M1, M2, M3 of Filip, Magedson, Markot 1986), and what runs along u or v, as
 * its borders do, within border_u / (8 m^2) or border_v / (8 n^2). */
struct limit_bound {
    float radius; /* of a sphere about the node's origin that holds the control points */
    float u, mixed, v;
    float border_u, border_v;
};

struct limit_tables {
    size_t n_faces; /* Ptex faces */
    size_t n_nodes;
    struct limit_node *nodes;
    struct limit_adjacency *adjacency; /* [n_faces] */
    size_t n_texels;
    float (*texels)[4];

    /* Bounds for the CPU's choice of grids; not on the GPU. bound_first[node] indexes bounds: one
     * for REGULAR, one for each level of a CORNER, one for a STRIP and one for each of its patches.
     */
    uint32_t *bound_first; /* [n_nodes] */
    struct limit_bound *bounds;
    size_t n_bounds;

    double box_min[3],
        box_max[3]; /* of the surface, by its limit positions: what a camera frames */
    /* Points of the surface that lie outermost, from the middle of the box (support.h); NULL until
     * they are looked for. */
    float (*support)[3];
    size_t n_support;
    double hull_min[3], hull_max[3]; /* of the control vertices: nothing lies outside */

    /* Counts for `sheen info`. */
    size_t n_regular, n_corner, n_strip, n_split, n_hole;
};

struct limit_plan; /* topology of the cage and the layout of its tables */

/* Asked at every face, whose corners may cost milliseconds: false ends the work, and `error` says
 * why. NULL for a watch: it goes on to its end. */
struct limit_watch {
    bool (*goes_on)(void *owner, struct error *error);
    void *owner;
};

static inline bool limit_goes_on(const struct limit_watch *watch, struct error *error)
{
    return !watch || watch->goes_on(watch->owner, error);
}

/* Reads the cage's topology and sizes the tables. The cage must outlive the plan. NULL on failure:
 * ERROR_MODEL for what is not evaluated yet, ERROR_SERVER when memory is short, or the watch's. */
struct limit_plan *limit_plan_create(const struct cage *cage, const struct limit_watch *watch,
                                     struct error *error);
void limit_plan_destroy(struct limit_plan *plan);

/* Allocates the tables of a plan. ERROR_SERVER names the bytes when there is no memory. */
bool limit_tables_init(struct limit_tables *tables, const struct limit_plan *plan,
                       struct error *error);
void limit_tables_finish(struct limit_tables *tables);

/* Fills the nodes and points of Ptex faces [first, last). Pure but for what it writes into that
 * range; disjoint ranges may run in different threads. ERROR_SERVER when memory is short, or the
 * watch's error. */
bool limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan, size_t first,
                       size_t last, const struct limit_watch *watch, struct error *error);

/* Bytes that the GPU holds for these tables: nodes + adjacency + texels. */
size_t limit_tables_bytes(const struct limit_tables *tables);
/* Bytes that they take in main memory, from limit_tables_init() on: the same and the bounds. */
size_t limit_tables_host_bytes(const struct limit_tables *tables);

#endif
