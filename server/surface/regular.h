/* Writes REGULAR nodes, for builders of any kind of surface. Pure, any thread; cannot fail. */
#ifndef SHEEN_SURFACE_REGULAR_H
#define SHEEN_SURFACE_REGULAR_H

#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* Subtracts the mean of a patch's 16 points from each of them. Returns the mean, which becomes the
 * origin of a REGULAR node. */
struct vec regular_centre(struct vec grid[16]);

/* The surface at a corner of a bicubic patch. Pass x = 1 for the corner at s = 0 and x = 2 for s =
 * 1; y likewise for t. Reads the 3 x 3 points about grid[4 y + x]. */
struct vec regular_corner_point(const struct vec grid[16], int x, int y);

/* Makes a node REGULAR: moves its 16 control points to their mean, and fills in the node's kind,
 * origin and first texel, its head, its bound and, in stored tables, LIMIT_PATCH_TEXELS texels from
 * `texel` on. */
void regular_write(struct limit_tables *tables, uint32_t node, struct vec grid[16], uint32_t texel);

/* Writes the head of a node without a frame of its own. The corners at t = 0 come from the points
 * `first`, those at t = 1 from `last`. */
void regular_write_head(struct limit_tables *tables, uint32_t node, const struct vec first[16],
                        const struct vec last[16]);
/* Writes one corner (0 to 3) of a head, relative to the node's origin. */
void regular_write_corner(struct limit_head *head, int corner, struct vec p);

#endif
