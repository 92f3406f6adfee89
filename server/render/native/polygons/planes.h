/* From the triangles that a tile's pixels show to the planes of stage 2, and the triangles' edges over the colour. Internal
 * to the folder; the thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_POLYGONS_PLANES_H
#define SHEEN_RENDER_NATIVE_POLYGONS_PLANES_H

#include "server/render/native/polygons/fill.h"
#include "server/render/native/stages.h"

/* Fills the planes of stage 2 and lists the groups of pixels near what is seen. The target holds which triangle each pixel
 * shows, too, until other planes are drawn into it. */
void native_polygon_planes(const struct native_drawing *drawing, const struct view *view,
                           const struct mesh *mesh, const struct native_seen_triangles *seen);
/* After native_shade(): wireframes' lines and what lies between in the place of the colour. */
void native_polygon_edges(const struct native_drawing *drawing, const struct view *view,
                          const struct mesh *mesh);

#endif
