/* One frame as it is asked of a device: what to show (scene.h), in which size, and which planes to
 * give back. Plain data; no ownership but what is said. Ranges: request_check.h. */
#ifndef SHEEN_SCENE_FRAME_REQUEST_H
#define SHEEN_SCENE_FRAME_REQUEST_H

#include "server/scene/scene.h"

/* Planes that a frame can carry, one bit each. */
enum frame_plane {
    PLANE_COLOUR = 1 << 0,       /* uint8_t[4] RGBA, straight alpha */
    PLANE_POSITION = 1 << 1,     /* float[3] world, NaN where nothing is hit */
    PLANE_NORMAL = 1 << 2,       /* float[3] unit, world, along the face winding; NaN where none */
    PLANE_PTEX = 1 << 3,         /* uint32 face (0xffffffff: none), float u, float v: 12 bytes */
    PLANE_LIGHT = 1 << 4,        /* float s, t on the first light; NaN where it is not met */
    PLANE_CURVATURE = 1 << 5,    /* float k.min, k.max, 1/unit, signed against N; NaN where none */
    PLANE_LIGHT_CHANGE = 1 << 6, /* float ds/dx ds/dy dt/dx dt/dy, a pixel; NaN as PLANE_LIGHT */
    PLANE_COVERAGE = 1 << 7,     /* float share of the pixel that shows surface, [0, 1] */
};
#define PLANE_COUNT 8

struct frame_request {
    uint32_t width_px, height_px;
    struct camera camera;
    struct lines lines;
    struct light lights[MAX_LIGHTS]; /* the first lies over the second, and so on */
    uint32_t n_lights;               /* 1 to MAX_LIGHTS */
    float miss[4];                   /* colour where no light is met */
    float empty[4];                  /* colour where no surface is hit */
    float base[4];                   /* of the surface, seen where a pattern's opacity is below 1 */
    bool unfiltered;                 /* one sample a pixel, of surface and pattern */
    bool aliased;                    /* one sample of the surface; patterns stay averaged */
    bool count_light;                /* count the pixels where lights are met: frame.met_px */
    uint32_t planes;                 /* enum frame_plane bits to read back */
    struct surface surface;
};

/* Does the request need the share of each pixel that shows surface? The colours of polygons, and of
 * frames of one sample of the surface a pixel, are made without it. */
static inline bool request_has_coverage(const struct frame_request *request)
{
    return !request->unfiltered && !request->aliased && request->surface.kind == SURFACE_EXACT;
}

/* Families that need no light: the lines are at infinity and every normal meets them. */
static inline bool family_is_at_infinity(enum line_family family)
{
    return family == LINES_ISOPHOTE || family == LINES_ZEBRA || family == LINES_ENVIRONMENT;
}

/* Must the pixels be counted where a light is met? Not where no light can be missed: what is at
 * infinity is met wherever there is a normal, and a sphere is met by every ray. */
static inline bool request_may_miss_light(const struct frame_request *request)
{
    bool may_miss = request->count_light && !family_is_at_infinity(request->lines.family);
    for (uint32_t i = 0; i < request->n_lights; i++)
        may_miss = may_miss && request->lights[i].kind != LIGHT_SPHERE;
    return may_miss;
}

#endif
