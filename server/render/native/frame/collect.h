/* Puts tiles of a picture together: their planes and lists, which later frames of the same view shade again. Internal
 * to the folder; the thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_COLLECT_H
#define SHEEN_RENDER_NATIVE_FRAME_COLLECT_H

#include "server/render/native/stages.h"

/* Adds a drawn tile to the target of its whole picture, on all threads of the device. False if memory is short, or if
 * these planes cannot serve another division into tiles, because the pixels at roundings are too many; then the
 * picture's planes are not to be kept. */
bool native_collect(const struct native_drawing *tile, struct native_target *picture);

#endif
