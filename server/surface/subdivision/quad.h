/* A quad with the rings of its four corners, on which its part of the limit surface depends.
 * Thread: that of the arena, and of the ring cache with its rings. Cannot fail.
 *
 * corner[i].at is this quad in ring i: ring_edge(0) is corner i+1, ring_face(0) corner i+2,
 * ring_edge(1) corner i+3. (u,v) is (0,0) at corner 0, (1,0) at 1, (1,1) at 2, (0,1) at 3. */
#ifndef SHEEN_SURFACE_SUBDIVISION_QUAD_H
#define SHEEN_SURFACE_SUBDIVISION_QUAD_H

#include <stdint.h>

#include "server/surface/subdivision/ring.h"

struct quad {
    struct ring corner[4];
};

/* The place of corner i in a 4x4 grid of control points, grid[y][x], and the steps along its first
 * edge (to corner i + 1) and its second (to corner i + 3). */
struct quad_corner {
    int x, y, first_x, first_y, second_x, second_y;
};
extern const struct quad_corner quad_corners[4];

/* Bit i set: corner i is extraordinary (its ring is not regular). */
unsigned quad_extraordinary(const struct quad *quad);

/* True if a corner has semi-sharp tags, so that its rules will change in further steps. */
bool quad_is_semisharp(const struct quad *quad);

/* The same quad with (0,0) at corner `by`. */
struct quad quad_rotated(const struct quad *quad, unsigned by);

/* One Catmull-Clark step: child[i] is the quarter at corner i, in the parent's orientation, with
 * settled rings (settle.h). */
void quad_refine(const struct quad *quad, struct arena *arena, struct quad child[4]);

/* The 4x4 B-spline control points grid[j + 1][i + 1], i along u and j along v in -1..2, with
 * phantom points beyond boundaries (server/surface/README.md 2). The point diagonally beyond a
 * corner is valid only if that corner is regular. */
void quad_grid(const struct quad *quad, struct vec grid[4][4]);

#endif
