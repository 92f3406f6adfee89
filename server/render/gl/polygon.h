/* Stages 1 and 2 of polygons: the planes that they fill for the exact surface, from a mesh; and the
 * polygons' edges. GL thread. */
#ifndef SHEEN_RENDER_GL_POLYGON_H
#define SHEEN_RENDER_GL_POLYGON_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/render/gl/polygon_kept.h"
#include "server/render/view.h"

struct gl_renderer;

/* A part of a tile's polygons. */
struct slice {
    const struct polygon_mesh *mesh;
    const struct view *view;
    const struct tile *tile;
    size_t part;      /* the next one to draw */
    size_t left;      /* indices that may be drawn yet; the last part may exceed them */
    size_t at_once;   /* after so many indices a flush makes the device begin with them */
    size_t not_begun; /* indices given since the last flush */
};

/* Clears the planes; then draws the polygons of a mesh that is whole, slice by slice. */
bool stage_polygons_begin(struct gl_renderer *r, const struct tile *tile, struct error *error);
bool stage_polygons(struct gl_renderer *r, struct slice *slice, struct error *error);
/* After stage_shade(): draws the polygons' edges over the colour, by the depths of
 * stage_polygons(), slice by slice. */
bool stage_wireframe(struct gl_renderer *r, struct slice *slice, struct error *error);

#endif
