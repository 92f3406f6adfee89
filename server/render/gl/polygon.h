/* Stages 1 and 2 for polygons: fill the same planes as for the exact surface, from a mesh; and draw
 * the edges of polygons. GL thread. */
#ifndef SHEEN_RENDER_GL_POLYGON_H
#define SHEEN_RENDER_GL_POLYGON_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/render/gl/polygon_kept.h"
#include "server/render/view.h"

struct gl_renderer;

/* A slice: a part of a tile's polygons. */
struct slice {
    const struct polygon_mesh *mesh;
    const struct view *view;
    const struct tile *tile;
    size_t part;      /* next part of the mesh to draw */
    size_t left;      /* indices that may still be drawn; the last part may exceed them */
    size_t at_once;   /* indices after which a flush makes the device start */
    size_t not_begun; /* indices passed since the last flush */
};

/* stage_polygons_begin() clears the planes; stage_polygons() then draws the polygons of a complete
 * mesh, slice by slice. */
bool stage_polygons_begin(struct gl_renderer *r, const struct tile *tile, struct error *error);
bool stage_polygons(struct gl_renderer *r, struct slice *slice, struct error *error);
/* After stage_shade(): draws the edges of the polygons over the colour, with the depths of
 * stage_polygons(), slice by slice. */
bool stage_wireframe(struct gl_renderer *r, struct slice *slice, struct error *error);

#endif
