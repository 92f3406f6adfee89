/* Stage 1: draws quads into a tile. */
#ifndef SHEEN_RENDER_NATIVE_LANES_RASTER_H
#define SHEEN_RENDER_NATIVE_LANES_RASTER_H

#include "server/render/native/lanes.h"
#include "server/render/native/tile.h"

/* Draws a quad, whose vertices or triangles are its thread's, where it is nearer than what is visible. */
void LANE_NAME(native_raster)(struct native_tile_room *room, const struct native_thread *thread,
                              const struct native_quad *quad, int piece);

#endif
