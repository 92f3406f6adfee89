/* The table of a quad with one extraordinary vertex: P_i(n,k) of Yasui and Kanai (2004), exact in
 * single precision.
 *
 * Level n (from 1) has the 24 control points of the n times refined net that the three patches of
 * the L-shaped band 2^-n <= max(u,v) <= 2^(1-n) need: the 5x5 grid (i,j) in -1..3 without (-1,-1)
 * (server/surface/README.md 3.2). Coordinates are in an orthonormal frame of the vertex, relative
 * to its limit position, divided by the level's scale. The limit position is moved back to zero at
 * every level, in double precision (README.md 3.3 explains why). server/surface/texels.h has the
 * layout in texels.
 *
 * The frame's third axis is the limit normal. If the vertex has none (ring_has_one_normal()), it is
 * the normal of the quad's own corner of the net at level 28, and the first axis is along the sum
 * of that corner's two edges. */
#ifndef SHEEN_SURFACE_SUBDIVISION_CORNER_H
#define SHEEN_SURFACE_SUBDIVISION_CORNER_H

#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/quad.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/tables.h"

/* The number of levels for a settled extraordinary ring, LIMIT_MIN_LEVELS to LIMIT_MAX_LEVELS
 * (README.md eq. 8). */
unsigned corner_levels(const struct ring *ring);

/* What a vertex's rule needs of its ring in addition to a window of the ring. */
enum window {
    WINDOW_NONE, /* nothing: the ring is whole, or its vertex is sharp */
    WINDOW_SUMS, /* the sums over all edges and over all faces of a smooth ring */
    WINDOW_ENDS, /* crease: the far ends of its two edges */
};

/* The net of one level: grid[j + 1][i + 1] for i,j = -1..3, and the ring of the vertex, or a window
 * of a large ring. */
struct net {
    struct vec grid[5][5];
    struct ring ring;
    enum window window;
    double n_faces; /* faces of the whole ring */
    struct vec edges, faces, end[2];
};

/* The nets of a corner, level by level. The rings lie in the arena passed to corner_begin(). */
struct corner_nets {
    struct vertex_limit own, *vertex; /* points to `own` if the ring cache has none */
    struct net net[2];                /* net[level & 1] is the net of `level` */
    struct vec axis[3];
    unsigned level;
};

/* Begins at level 0 of a quad whose corner 0 is the extraordinary vertex and which has no
 * semi-sharp tags. `known` has masks of darts that were found before; those of other darts are
 * found here. nets->vertex tells whether the vertex has a limit normal. Cannot fail: the arena is
 * large enough. Thread: that of the arena and of the ring cache. */
void corner_begin(struct corner_nets *nets, const struct quad *quad,
                  const struct dart_mask_list *known, struct arena *arena);

/* Advances by one level and returns its points grid[5 (j + 1) + i + 1], valid until the next call;
 * the first point is not set. */
const struct vec *corner_next_level(struct corner_nets *nets);

/* The bound of a level's points. */
struct limit_bound corner_level_bound(const struct vec grid[25], unsigned level);

/* Writes the frame as a quaternion, and the vertex's limit position. */
void corner_write_head(const struct corner_nets *nets, float frame[4], double origin[3]);

/* Writes the table of nets that have just begun: LIMIT_CORNER_TEXELS(levels) texels, and `levels`
 * bounds. */
void corner_write_levels(struct corner_nets *nets, unsigned levels, float (*texels)[4],
                         struct limit_bound *bounds);

#endif
