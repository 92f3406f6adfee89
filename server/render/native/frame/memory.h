/* The memory that frames are drawn on: frame_bytes(), paused_bytes(), held() and
 * drop_held() of struct renderer_device. Internal to the device; render thread, but for the first
 * two. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_MEMORY_H
#define SHEEN_RENDER_NATIVE_FRAME_MEMORY_H

#include "server/render/device.h"

uint64_t native_frame_bytes(const struct renderer_frame_size *size);
uint64_t native_frame_paused_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px);
struct renderer_held native_frame_held(const struct renderer *renderer);
void native_frame_drop_held(struct renderer *renderer);

#endif
