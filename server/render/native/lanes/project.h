/* Projects places of a sub-patch into the picture, in single precision relative to the origin of their node. */
#ifndef SHEEN_RENDER_NATIVE_LANES_PROJECT_H
#define SHEEN_RENDER_NATIVE_LANES_PROJECT_H

#include <string.h>

#include "server/render/native/frame.h"
#include "server/render/native/lanes.h"

/* Of a quad's four corners. */
LANE_INLINE float least_of(const float a[4])
{
    float x = a[0] < a[1] ? a[0] : a[1], y = a[2] < a[3] ? a[2] : a[3];
    return x < y ? x : y;
}

LANE_INLINE float largest_of(const float a[4])
{
    float x = a[0] > a[1] ? a[0] : a[1], y = a[2] > a[3] ? a[2] : a[3];
    return x > y ? x : y;
}

/* A node in camera space. */
struct placed_node {
    float at[3], before;
    float camera[3][3]; /* native_seen_node.camera */
};

LANE_INLINE struct placed_node place_node(const struct native_frame *frame, uint32_t node)
{
    struct native_seen_node seen;
    native_see_node(frame, &frame->model->tables->nodes[node], &seen);
    struct placed_node placed = {
        {(float)seen.at[0], (float)seen.at[1], (float)seen.at[2]}, (float)seen.before, {{0}}};
    memcpy(placed.camera, seen.camera, sizeof seen.camera);
    return placed;
}

/* How a sub-patch is projected. */
struct projection {
    const struct native_rays *rays;
    const struct placed_node *node;
    const struct native_patch *patch;
    float turn[3][3]; /* from the patch's coefficients to camera space */
};

LANE_INLINE struct projection projection_of(const struct native_rays *rays,
                                            const struct placed_node *node,
                                            const struct native_patch *patch)
{
    struct projection on = {rays, node, patch, {{0}}};
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++)
            on.turn[a][k] = patch->scale * node->camera[a][k];
    return on;
}

/* Projects s, t: px of the picture, depth in units, and nearness (frame.h). */
LANE_INLINE void project(const struct projection *on, vfloat s, vfloat t, vfloat *x, vfloat *y,
                         vfloat *z, vfloat *nearness)
{
    const struct native_rays *rays = on->rays;
    vfloat p[3], at[3];
    for (int k = 0; k < 3; k++) {
        vfloat row[4];
        for (int j = 0; j < 4; j++) {
            const float *c = on->patch->c[k][j];
            row[j] = ((c[3] * s + c[2]) * s + c[1]) * s + c[0];
        }
        p[k] = ((row[3] * t + row[2]) * t + row[1]) * t + row[0];
    }
    for (int a = 0; a < 3; a++)
        at[a] = p[0] * on->turn[a][0] + p[1] * on->turn[a][1] + p[2] * on->turn[a][2];
    vfloat before = on->node->before - at[2], px = v_float(1 / rays->start_px);
    *z = at[2] + on->node->at[2];
    *nearness = before;
    if (rays->perspective) {
        vfloat inverse = 1 / *z;
        *nearness = before * inverse;
        px = inverse * (1 / rays->slope_px);
    }
    *x = (at[0] + on->node->at[0]) * px + rays->centre_px[0];
    *y = (at[1] + on->node->at[1]) * px + rays->centre_px[1];
}

#endif
