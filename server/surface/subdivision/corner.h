/* The table of a quad with one extraordinary vertex: P_i(n,k) of Yasui and Kanai (2004), exact in
 * single precision.
 *
 * Level n (from 1) holds the 24 control points of the n times refined net that the three patches of the
 * L-shaped band 2^-n <= max(u,v) <= 2^(1-n) need: the 5x5 grid (i,j) in -1..3 without (-1,-1)
 * (server/surface/README.md 3.2). Coordinates are in an orthonormal frame of the vertex, relative to its
 * limit position, divided by the level's scale. The limit position is moved back to zero at every level,
 * in double (README.md 3.3 says why). How the points lie in texels: server/surface/texels.h.
 *
 * The frame's third axis is the limit normal. Where the vertex has none (ring_has_one_normal()) it is the
 * normal of the quad's own corner of the net at level 28, and the first axis lies along the sum of that
 * corner's two edges. */
#ifndef SHEEN_SURFACE_SUBDIVISION_CORNER_H
#define SHEEN_SURFACE_SUBDIVISION_CORNER_H

#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/quad.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/tables.h"

/* How many levels the table of a settled extraordinary ring has, LIMIT_MIN_LEVELS to LIMIT_MAX_LEVELS
 * (README.md eq. 8). */
unsigned corner_levels(const struct ring *ring);

/* What the rule of a vertex takes of its ring that a window of the ring lacks. */
enum window {
    WINDOW_NONE, /* the ring is whole, or its vertex sharp */
    WINDOW_SUMS, /* over all edges and over all faces of a smooth ring */
    WINDOW_ENDS, /* of a crease: the far ends of its two edges */
};

/* The net of one level: grid[j + 1][i + 1] for i,j = -1..3, and the ring of the vertex, or a
 * window of a large ring. */
struct net {
    struct vec grid[5][5];
    struct ring ring;
    enum window window;
    double n_faces; /* of the whole ring */
    struct vec edges, faces, end[2];
};

/* The nets of a corner, from level to level. Its rings lie in the arena that it was begun with. */
struct corner_nets {
    struct vertex_limit own, *vertex; /* `own` where the ring cache has none */
    struct net net[2];                /* net[level & 1] is that of `level` */
    struct vec axis[3];
    unsigned level;
};

/* Begins at level 0 of a quad whose corner 0 is the extraordinary vertex and which has no semi-sharp
 * tags. `known` are the masks of darts that have been found before; those of another dart are found
 * here. nets->vertex says whether the vertex has a limit normal. Never fails: the arena has been
 * sized for it. Thread: the arena's, and that of the ring cache which holds the quad's rings. */
void corner_begin(struct corner_nets *nets, const struct quad *quad,
                  const struct dart_mask_list *known, struct arena *arena);

/* Goes on by one level: its points grid[5 (j + 1) + i + 1], the first of which is not set. They stay
 * until the next call. */
const struct vec *corner_next_level(struct corner_nets *nets);

/* How far the points of a level reach and how much they bend. */
struct limit_bound corner_level_bound(const struct vec grid[25], unsigned level);

/* The frame as a quaternion, and the vertex's limit position. */
void corner_write_head(const struct corner_nets *nets, float frame[4], double origin[3]);

/* The table of nets that have just begun: LIMIT_CORNER_TEXELS(levels) texels, bounds[0, levels). */
void corner_write_levels(struct corner_nets *nets, unsigned levels, float (*texels)[4],
                         struct limit_bound *bounds);

#endif
