/* The two triangles that a cell of a piece is drawn as. */
#ifndef SHEEN_RENDER_NATIVE_LANES_HALF_H
#define SHEEN_RENDER_NATIVE_LANES_HALF_H

#include <math.h>

#include "server/render/native/lanes.h"

/* A triangle covers pixels this far beyond its edges: neighbours round shared vertices differently, by up to 2^-10 px
 * at 30,000 px from the picture's corner, and no gap may open between them. */
#define SLACK_PX (1.0f / 512)
#define PLACE_STEPS 65535.0f /* of a position along a piece */

/* One of a cell's two triangles: with p its first vertex, q and r the others, a point is p + b (q - p) + c (r - p).
 * The unit is a pixel. */
struct half {
    /* b' = bx x + by y + b0 is b - least_b, and c' = cx x + cy y + c0 is c - least_c. A point is inside where b' > 0,
     * c' > 0 and b' + c' < most; with SLACK_PX = 0 these would be b > 0, c > 0 and b + c < 1. */
    float bx, by, b0, cx, cy, c0;
    float least_b, least_c, most;
    float rise_b, rise_c; /* of the nearness */
};

/* The triangle of vertices p, q and r, in pixels right of `left` and below `top`. */
LANE_INLINE struct half half_of(float left, float top, const float x[4], const float y[4],
                                const float nearness[4], int p, int q, int r)
{
    float at_x = x[p] - left, at_y = y[p] - top;
    float qx = x[q] - x[p], qy = y[q] - y[p], rx = x[r] - x[p], ry = y[r] - y[p];
    float area = qx * ry - rx * qy, inverse = area != 0 ? 1 / area : 0;
    struct half h = {
        .bx = ry * inverse, .by = -rx * inverse, .cx = -qy * inverse, .cy = qx * inverse};
    h.least_b = -SLACK_PX * (fabsf(h.bx) + fabsf(h.by));
    h.least_c = -SLACK_PX * (fabsf(h.cx) + fabsf(h.cy));
    h.b0 = -(h.bx * at_x + h.by * at_y) - h.least_b;
    h.c0 = -(h.cx * at_x + h.cy * at_y) - h.least_c;
    h.most = area != 0
                 ? 1 + SLACK_PX * (fabsf(h.bx + h.cx) + fabsf(h.by + h.cy)) - h.least_b - h.least_c
                 : -1;
    h.rise_b = nearness[q] - nearness[p];
    h.rise_c = nearness[r] - nearness[p];
    return h;
}

/* Positive inside; b and c are b' and c'. */
LANE_INLINE vfloat inside(const struct half *h, vfloat b, vfloat c)
{
    return v_min(v_min(b, c), h->most - (b + c));
}

#endif
