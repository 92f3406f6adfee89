/* From a target's planes to those of a frame. Internal to the folder. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_READBACK_H
#define SHEEN_RENDER_NATIVE_FRAME_READBACK_H

#include "server/render/native/stages.h"

/* Copies the planes asked for of the tile that `drawing` is about into the frame. */
void native_readback(const struct native_drawing *drawing, const struct view *view,
                     struct frame *frame);

#endif
