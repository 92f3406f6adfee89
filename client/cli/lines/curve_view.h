/* Curves as a camera sees them: places in the picture, and which parts are visible.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_CURVE_VIEW_H
#define SHEEN_CLIENT_CURVE_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* A camera and a picture. */
struct projection {
    struct sheen_camera camera;
    uint32_t width_px, height_px;
    double right[3], above[3], forward[3]; /* unit */
    double scale; /* px for each unit at depth 1; orthographic: at every depth */
};

void projection_init(struct projection *projection, const struct sheen_camera *camera,
                     uint32_t width_px, uint32_t height_px);
/* The place of a point in the picture, px: 0,0 is its top left corner. Returns the depth along the
 * line of sight, which is above 0 in front of the camera. */
double projection_place(const struct projection *projection, const double point[3],
                        double place[2]);
/* How a tangent at `point` runs in the picture, px for each unit; of any length. */
void projection_tangent(const struct projection *projection, const double point[3],
                        const double along[3], double tangent[2]);

/* A place on a curve: point k and the share of the way to the next point, as k + share. */
void curve_at(const struct sheen_curve *curve, double at, double point[3], double along[3]);

/* A part of a curve from `from` to `to`, as curve_at() counts; of a closed curve up to n_points. */
struct curve_part {
    uint32_t curve;
    bool visible;
    double from, to;
};

/* What the camera sees, at the centres of pixels: the planes of a frame. */
struct view_planes {
    uint32_t width_px, height_px;
    const float (*position)[3]; /* NaN: no surface */
    const float (*normal)[3];
};

/* Cuts all curves into visible and hidden parts: a point is hidden if the surface at its pixel lies
 * before it. The places of cuts are found to 0.1 px along the curve. Returns the parts, malloc'd,
 * in the order of curves; NULL when memory is short. */
struct curve_part *curve_parts(const struct sheen_curves *curves,
                               const struct projection *projection,
                               const struct view_planes *planes, size_t *n);

#endif
