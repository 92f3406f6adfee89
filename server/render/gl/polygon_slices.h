/* Draws frames of polygons slice by slice, because a mesh of millions of triangles occupies a
 * software device for seconds, and other frames are drawn in between. The drawn part of a tile
 * stays in its planes, which are set aside meanwhile, so that the picture does not depend on the
 * interruption. GL thread. */
#ifndef SHEEN_RENDER_GL_POLYGON_SLICES_H
#define SHEEN_RENDER_GL_POLYGON_SLICES_H

#include <stdbool.h>

#include "server/base/error.h"
#include "server/render/view.h"
#include "server/scene/frame.h"

struct gl_frame;
struct gl_model;
struct gl_renderer;

/* Draws the next part of a tile of polygons, as much as a step may take. *is_whole: it was the last
 * part, and the tile is in the frame. */
bool draw_polygons(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                   const struct view *view, const struct tile *drawn, struct frame *frame,
                   bool *is_whole, struct error *error);

#endif
