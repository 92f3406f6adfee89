/* What sets.h lists of an instruction set. */
#ifndef SHEEN_RENDER_NATIVE_LANES_ENTRIES_H
#define SHEEN_RENDER_NATIVE_LANES_ENTRIES_H

#include "server/render/native/frame.h"
#include "server/render/native/lanes.h"

void LANE_NAME(native_pieces)(struct native_frame *frame, struct native_thread *thread,
                              uint32_t number);
void LANE_NAME(native_tile)(struct native_frame *frame, struct native_thread *thread,
                            uint32_t number);
void LANE_NAME(native_gaps)(struct native_frame *frame, struct native_thread *thread);

#endif
