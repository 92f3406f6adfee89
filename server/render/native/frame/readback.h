/* Copies a target's planes to those of a frame. Internal to the folder. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_READBACK_H
#define SHEEN_RENDER_NATIVE_FRAME_READBACK_H

#include "server/render/native/stages.h"

/* Copies the requested planes of the tile of `drawing` into the frame. */
void native_readback(const struct native_drawing *drawing, const struct view *view,
                     struct frame *frame);

#endif
