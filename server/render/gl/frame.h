/* Draws one frame on this device: its tiles, and the three stages of each. GL thread, except where
 * noted. */
#ifndef SHEEN_RENDER_GL_FRAME_H
#define SHEEN_RENDER_GL_FRAME_H

#include "server/render/device.h"

/* The functions of struct renderer_device. A step on a lost device fails. */
bool gl_frame_begin(struct renderer *renderer, struct frame_work *work, struct error *error);
enum frame_step gl_frame_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error);
uint64_t gl_frame_bytes(const struct renderer_frame_size *size);
uint64_t gl_paused_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px);

#endif
