/* Stage 1: quads into what a tile sees. */
#ifndef SHEEN_RENDER_NATIVE_LANES_RASTER_H
#define SHEEN_RENDER_NATIVE_LANES_RASTER_H

#include "server/render/native/lanes.h"
#include "server/render/native/tile.h"

/* Where the quad, whose vertices or triangles its thread has, lies nearer than what is seen. */
void LANE_NAME(native_raster)(struct native_tile_room *room, const struct native_thread *thread,
                              const struct native_quad *quad, int piece);

#endif
