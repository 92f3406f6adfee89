/* The functions of one instruction set that sets.h lists. */
#ifndef SHEEN_RENDER_NATIVE_LANES_ENTRIES_H
#define SHEEN_RENDER_NATIVE_LANES_ENTRIES_H

#include "server/render/native/frame.h"
#include "server/render/native/lanes.h"
#include "server/render/native/polygons/fill.h"
#include "server/render/native/rays/rays.h"

void LANE_NAME(native_pieces)(struct native_frame *frame, struct native_thread *thread,
                              uint32_t number);
void LANE_NAME(native_tile)(struct native_frame *frame, struct native_thread *thread,
                            uint32_t number);
void LANE_NAME(native_gaps)(struct native_frame *frame, struct native_thread *thread);
void LANE_NAME(native_place)(struct native_slice *slice, struct native_polygon_thread *thread,
                             uint32_t number);
void LANE_NAME(native_triangles)(struct native_slice *slice, uint32_t number);

bool LANE_NAME(native_see_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                                struct native_ray_room *room);
void LANE_NAME(native_meet_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                                 struct native_ray_room *room);
void LANE_NAME(native_describe_rays)(const struct native_frame *frame,
                                     struct native_tile_room *tile, struct native_ray_room *room,
                                     float (*hit)[HIT_WORDS]);

/* Fills in rows first to end - 1 of `seen`, where first is a multiple of GROUP_HEIGHT, and lists the groups there
 * that show surface or are next to some: x | y << 16, in groups. Returns their number. `columns` is memory for a
 * row. */
uint32_t LANE_NAME(native_groups)(const struct native_seen *seen, uint32_t first, uint32_t end,
                                  float *columns, uint32_t *groups);

#endif
