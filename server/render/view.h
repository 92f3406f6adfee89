/* The camera in double precision, and in the form that shaders read. Pure, any thread. */
#ifndef SHEEN_RENDER_VIEW_H
#define SHEEN_RENDER_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/tiles.h"
#include "server/scene/frame_request.h"

/* A camera. Camera space has x right, y down, z forward from the eye (shaders/view.glsl). */
struct view {
    double eye[3];
    double axis[3][3]; /* right, down, forward: orthonormal, world */
    bool perspective;
    double units_per_px; /* orthographic: everywhere; perspective: at depth 1 */
    double centre_px[2]; /* the pixel on the forward axis */
    double near, far;    /* range of visible depths */
    uint32_t width_px, height_px;
};

/* The std140 block `View` of shaders/view.glsl. */
struct view_block {
    _Alignas(32) double eye[4]; /* as a dvec4 in the programs of the native device */
    float axis[3][4];
    float ray[4];
    float clip[4];
    float depth[4];
    int32_t tile[4];
};

/* Where a frame is in its picture: the picture's size, and the place of the frame's top left pixel, px.
 * Views and tiles that are drawn are those of the picture, so that its part has the same pixels. */
struct view_part {
    uint32_t x, y;
    struct tile_size picture;
};

/* The part of a checked request: the whole picture, or that of camera.window. */
struct view_part view_part_of(const struct frame_request *request);
/* Converts a tile of the frame to coordinates of the picture. */
struct tile view_tile(const struct view_part *part, const struct tile *tile);

/* Sets up the picture's view for a checked camera and a frame of this size. The box contains what is
 * drawn, and sets near and far. */
void view_init(struct view *view, const struct camera *camera, uint32_t width_px,
               uint32_t height_px, const double box_min[3], const double box_max[3]);
void view_block_fill(struct view_block *block, const struct view *view, const struct tile *tile);

/* Transforms from world to camera space. */
void view_transform(const struct view *view, const double world[3], double camera[3]);
/* The world position at depth z on the ray of a pixel's centre, computed in double precision. */
void view_position(const struct view *view, uint32_t x, uint32_t y, double z, float world[3]);

/* The part of camera space that a tile may show: between four planes, beyond the nearest depth. */
struct view_sides {
    double side[4][3]; /* unit inward normals */
    double offset[4];  /* signed distance = side . p + offset */
    double near;
};

void view_sides_init(struct view_sides *sides, const struct view *view, const struct tile *tile);
/* True if a sphere in camera space lies outside. */
bool view_sides_exclude(const struct view_sides *sides, const double centre[3], double radius);

#endif
