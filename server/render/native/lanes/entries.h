/* What sets.h lists of an instruction set. */
#ifndef SHEEN_RENDER_NATIVE_LANES_ENTRIES_H
#define SHEEN_RENDER_NATIVE_LANES_ENTRIES_H

#include "server/render/native/frame.h"
#include "server/render/native/lanes.h"
#include "server/render/native/polygons/fill.h"

void LANE_NAME(native_pieces)(struct native_frame *frame, struct native_thread *thread,
                              uint32_t number);
void LANE_NAME(native_tile)(struct native_frame *frame, struct native_thread *thread,
                            uint32_t number);
void LANE_NAME(native_gaps)(struct native_frame *frame, struct native_thread *thread);
void LANE_NAME(native_place)(struct native_slice *slice, struct native_polygon_thread *thread,
                             uint32_t number);
void LANE_NAME(native_triangles)(struct native_slice *slice, uint32_t number);

#endif
