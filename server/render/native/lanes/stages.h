/* The steps of stage 2 for a tile. */
#ifndef SHEEN_RENDER_NATIVE_LANES_STAGES_H
#define SHEEN_RENDER_NATIVE_LANES_STAGES_H

#include "server/render/native/lanes/surface.h"
#include "server/render/native/tile.h"

/* Converts nearness to the distance from the far depth. */
LANE_INLINE vfloat v_before(const struct native_rays *rays, vfloat nearness)
{
    return rays->perspective ? rays->far * nearness / (1 + nearness) : nearness;
}

LANE_INLINE float before_of(const struct native_rays *rays, float nearness)
{
    return rays->perspective ? rays->far * nearness / (1 + nearness) : nearness;
}

/* Makes room for n pieces of a tile: room->local, ->quad, ->count and ->order. False when memory is short. */
bool LANE_NAME(native_reserve_local)(struct native_tile_room *room, size_t n);

/* Evaluates the pixels, sorted by piece: those whose guess leads to a place on its sub-patch are written; the others
 * become strays. */
void LANE_NAME(native_evaluate)(const struct native_frame *frame, struct native_tile_room *room);

/* Finds where the rays of the room's tasks meet the surface. */
void LANE_NAME(native_meet)(const struct native_frame *frame, struct native_tile_room *room);

/* Writes hits at some pixels into the tile's planes. */
void LANE_NAME(native_write)(const struct native_frame *frame, struct native_tile_room *room,
                             const uint16_t *pixel, const struct native_met *const *met, size_t n);

#endif
