/* Pictures of how far two frames of one camera differ, in colours of a scale. Pure, any thread. */
#ifndef SHEEN_CLIENT_HEAT_MAP_H
#define SHEEN_CLIENT_HEAT_MAP_H

#include "client/cli/output/canvas.h"

enum heat_kind { HEAT_NORMAL, HEAT_DISTANCE };

/* Fills a canvas of the frames' size from their planes of positions and normals: the angle of the
 * normals, or the distance along the old normal. The scale ends at `most`; grey: no surface;
 * magenta: on one side only. */
void heat_map_paint(struct canvas *canvas, enum heat_kind kind, const struct sheen_frame *old,
                    const struct sheen_frame *new, double most);
/* Fills a canvas with the scale, from 0 on the left to `most` on the right. */
void heat_map_paint_scale(struct canvas *canvas);

#endif
