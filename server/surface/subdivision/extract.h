/* Quads with their rings, from the cage: of the cage itself (level 0) where all faces around a quad are
 * quads, else of the once refined cage (level 1), where all faces are.
 *
 * The points of level 1 are computed once for the whole cage, if it has a face that is no quad. */
#ifndef SHEEN_SURFACE_SUBDIVISION_EXTRACT_H
#define SHEEN_SURFACE_SUBDIVISION_EXTRACT_H

#include "server/surface/subdivision/quad.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/topology/half_edges.h"
#include "server/surface/watch.h"

struct refined_points {
    struct vec *vertex; /* [vertices] */
    struct vec *edge;   /* [corners]: of the corner's half-edge; twins hold the same */
    struct vec *face;   /* [faces] */
};

/* Computes the points of level 1. False: ERROR_SERVER when memory is short, or the watch's error;
 * refined_points_finish() is safe in both cases. One thread. */
bool refined_points_init(struct refined_points *points, const struct topology *topology,
                         struct arena *arena, const struct limit_watch *watch, struct error *error);
void refined_points_finish(struct refined_points *points);

/* The quad whose corner 0 is the cage corner c, at level 0, its rings settled (settle.h). Large
 * ones are kept in `rings`, where they are looked for first. */
struct quad extract_quad(const struct topology *topology, uint32_t c, struct ring_cache *rings,
                         struct arena *arena);

/* The 4x4 control points of a plain quad (half_edges.h), as quad_grid() gives them, without its
 * rings. */
void extract_plain_grid(const struct topology *topology, uint32_t c, struct vec grid[4][4]);

/* The level-1 quad between cage corner c (its corner 0), the edge points beside it and the face
 * point (its corner 2). */
struct quad extract_refined_quad(const struct topology *topology,
                                 const struct refined_points *points, uint32_t c,
                                 struct ring_cache *rings, struct arena *arena);

/* The most faces around any vertex, or corners of any face, of the cage. */
size_t extract_largest_ring(const struct topology *topology);

#endif
