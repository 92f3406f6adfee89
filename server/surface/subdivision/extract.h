/* Extracts quads with their rings from the cage: of the cage itself (level 0) if all faces around a
 * quad are quads, else of the once refined cage (level 1), where all faces are quads.
 *
 * If the cage has a face that is not a quad, the points of level 1 are computed once for the whole
 * cage. */
#ifndef SHEEN_SURFACE_SUBDIVISION_EXTRACT_H
#define SHEEN_SURFACE_SUBDIVISION_EXTRACT_H

#include "server/surface/subdivision/quad.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/topology/half_edges.h"
#include "server/surface/watch.h"

struct refined_points {
    struct vec *vertex; /* [vertices] */
    struct vec *edge;   /* [corners]: the point on the corner's half-edge; the same for twins */
    struct vec *face;   /* [faces] */
};

/* Computes the points of level 1. False with ERROR_SERVER when memory is short, or with the watch's
 * error; refined_points_finish() is safe in both cases. One thread. */
bool refined_points_init(struct refined_points *points, const struct topology *topology,
                         struct arena *arena, const struct limit_watch *watch, struct error *error);
void refined_points_finish(struct refined_points *points);

/* The level-0 quad whose corner 0 is cage corner c, with settled rings (settle.h). Large rings are
 * looked up in `rings` and kept there. */
struct quad extract_quad(const struct topology *topology, uint32_t c, struct ring_cache *rings,
                         struct arena *arena);

/* The 4x4 control points of a plain quad (half_edges.h), like quad_grid() but without rings. */
void extract_plain_grid(const struct topology *topology, uint32_t c, struct vec grid[4][4]);

/* The level-1 quad between cage corner c (its corner 0), the edge points beside it, and the face
 * point (its corner 2). */
struct quad extract_refined_quad(const struct topology *topology,
                                 const struct refined_points *points, uint32_t c,
                                 struct ring_cache *rings, struct arena *arena);

/* The largest number of faces around a vertex, or corners of a face, in the cage. */
size_t extract_largest_ring(const struct topology *topology);

#endif
