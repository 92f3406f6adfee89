/* What searches for the nearest point need to know about a CORNER: its extraordinary vertex, and
 * bounds of its points. The part of a CORNER inside its last part level is called the rest: many
 * patches, each level about half as large as the one before, so that a search first finds the level
 * and only then uses Newton's method. Where hundreds of faces meet at a vertex, boxes of their
 * patches overlap; two planes through the vertex bound each face to its own sector.
 *
 * Plain data: one thread fills it, and then any thread may read it. Nothing here can fail. */
#ifndef SHEEN_CURVES_COMPARE_SECTOR_H
#define SHEEN_CURVES_COMPARE_SECTOR_H

#include "server/curves/compare/kept_surface.h"

struct corner_sector {
    struct limit_point vertex;
    double width; /* of the rest's square in the leaf */
    /* How far the rest's outer corner, and that of the square half as large, lie from the
     * vertex. */
    double extent, half_extent;
    /* side[k].(q - vertex) >= 0 for each point q of the leaf. Each side[k] has unit length and is
     * perpendicular to the vertex's normal; both are zero where the leaf has no such bound. */
    struct vec side[2];
    /* Range of normal.(q - vertex) of the rest; infinite where the vertex has no normal. */
    double least_height, most_height;
};

/* Fills `sector` for leaf `leaf`, which is a CORNER whose levels kept_surface_fill() has made. */
void corner_sector_init(struct corner_sector *sector, const struct kept_surface *surface,
                        size_t leaf);

/* Narrows the range of t to where p + t n may lie in the leaf. False if nothing is left. */
bool corner_sector_clip(const struct corner_sector *sector, struct vec p, struct vec n,
                        double range[2]);

/* A lower bound of the distance of p from a part of the leaf that is at least `above` away along
 * the vertex's normal. */
double corner_sector_distance(const struct corner_sector *sector, struct vec p, double above);

/* How far p is from the rest along the vertex's normal, at least. */
double corner_rest_above(const struct corner_sector *sector, struct vec p);

/* Gets three starting places for Newton's method in the rest. They lie in the square about the
 * vertex whose outer corner is at most about 1.5 `away` from the vertex; `away` is above 0, in
 * units. Returns the side of that square. `made` may be NULL, as in
 * kept_surface_evaluate_again(). */
double corner_rest_starts(const struct corner_sector *sector, const struct kept_surface *surface,
                          size_t leaf, double away, struct made_levels *made, double starts[3][2]);

#endif
