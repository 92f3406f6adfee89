/* The request for one frame that a device gets: what to show (scene.h), the size, and the planes to
 * return. Plain data, owned by the caller. request_check.h checks its ranges. */
#ifndef SHEEN_SCENE_FRAME_REQUEST_H
#define SHEEN_SCENE_FRAME_REQUEST_H

#include "server/scene/scene.h"

/* Planes that a frame can carry, one bit each. */
enum frame_plane {
    PLANE_COLOUR = 1 << 0,   /* uint8_t[4] RGBA, sRGB, straight alpha */
    PLANE_POSITION = 1 << 1, /* float[3], world; NaN without a surface */
    /* float[3], unit length, by the faces' winding; NaN without a surface. */
    PLANE_NORMAL = 1 << 2,
    PLANE_PTEX = 1 << 3,  /* uint32 face (0xffffffff: none), float u, float v: 12 bytes */
    PLANE_LIGHT = 1 << 4, /* float s, t on the first light; NaN where the ray misses it */
    /* Float k.min, k.max, 1/unit, signed by N; NaN without a surface. */
    PLANE_CURVATURE = 1 << 5,
    /* Float ds/dx ds/dy dt/dx dt/dy per pixel; NaN where PLANE_LIGHT is. */
    PLANE_LIGHT_CHANGE = 1 << 6,
    PLANE_COVERAGE = 1 << 7, /* float, share of the pixel that shows the surface, 0 to 1 */
};
#define PLANE_COUNT 8

struct frame_request {
    uint32_t width_px, height_px;
    /* The diagonal of the model's box, by which the camera (has_chosen_camera) and lights were chosen that
     * the request leaves out. */
    double model_size;
    bool has_chosen_camera;
    struct camera camera;
    struct lines lines;
    struct light lights[MAX_LIGHTS]; /* the first lies over the second, and so on */
    uint32_t n_lights;               /* 1 to MAX_LIGHTS */
    float miss[4];                   /* colour where the ray meets no light, RGBA as displayed */
    float empty[4];                  /* colour without a surface */
    /* Colour of the surface, visible where a pattern's opacity is below 1. */
    float base[4];
    bool unfiltered; /* one sample of surface and pattern for each pixel */
    /* One sample of the surface for each pixel; patterns are averaged. */
    bool aliased;
    bool count_light; /* count the pixels whose ray meets a light (frame.met_px) */
    uint32_t planes;  /* bits of enum frame_plane to return */
    struct surface surface;
};

/* Does the request need the share of each pixel that shows the surface? Polygons, and frames with
 * one sample of the surface for each pixel, are coloured without it. */
static inline bool request_has_coverage(const struct frame_request *request)
{
    return !request->unfiltered && !request->aliased && request->surface.kind == SURFACE_EXACT;
}

/* True for families that need no light: their lines lie at infinity, and every normal meets
 * them. */
static inline bool family_is_at_infinity(enum line_family family)
{
    return family == LINES_ISOPHOTE || family == LINES_ZEBRA || family == LINES_ENVIRONMENT;
}

/* Must the pixels be counted whose ray meets a light? Not if no light can be missed: lines at
 * infinity are met wherever there is a normal, and a sphere is met by every ray. */
static inline bool request_may_miss_light(const struct frame_request *request)
{
    bool may_miss = request->count_light && !family_is_at_infinity(request->lines.family);
    for (uint32_t i = 0; i < request->n_lights; i++)
        may_miss = may_miss && request->lights[i].kind != LIGHT_SPHERE;
    return may_miss;
}

#endif
