/* Computes the planes of stage 2 from the triangles that a tile's pixels show, and draws the triangles' edges over
 * the colour. Internal to the folder; the thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_POLYGONS_PLANES_H
#define SHEEN_RENDER_NATIVE_POLYGONS_PLANES_H

#include "server/render/native/polygons/fill.h"
#include "server/render/native/stages.h"

/* Fills the planes of stage 2 and lists the groups of pixels near visible surface. The target also keeps the triangle
 * of each pixel until other planes are drawn into it. */
void native_polygon_planes(const struct native_drawing *drawing, const struct view *view,
                           const struct mesh *mesh, const struct native_seen_triangles *seen);
/* After native_shade(): replaces the colour by the lines of a wireframe and the colour between them. */
void native_polygon_edges(const struct native_drawing *drawing, const struct view *view,
                          const struct mesh *mesh);

#endif
