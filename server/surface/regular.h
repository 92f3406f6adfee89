/* Writes REGULAR nodes, for builders of any kind of surface. Pure, any thread; cannot fail. */
#ifndef SHEEN_SURFACE_REGULAR_H
#define SHEEN_SURFACE_REGULAR_H

#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* Moves the mean of a patch's points to zero and returns it: the origin of a REGULAR node. */
struct vec regular_centre(struct vec grid[16]);

/* The surface at a corner of a bicubic patch: x and y are 1 for 0 and 2 for 1. Of the 16 points the 3 x 3 about (x,y)
 * are read. */
struct vec regular_corner_point(const struct vec grid[16], int x, int y);

/* Makes a node REGULAR: moves its 16 control points to their mean, and fills in the node's kind, origin and first texel,
 * its head, its bound and, in stored tables, LIMIT_PATCH_TEXELS texels from `texel` on. */
void regular_write(struct limit_tables *tables, uint32_t node, struct vec grid[16], uint32_t texel);

/* Write the head of a node without a frame of its own: the corners at t = 0 from the points of one patch, those at t = 1
 * from those of another. And one corner of a head. */
void regular_write_head(struct limit_tables *tables, uint32_t node, const struct vec first[16],
                        const struct vec last[16]);
void regular_write_corner(struct limit_head *head, int corner, struct vec p);

#endif
