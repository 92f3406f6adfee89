/* Copies the target's images to the planes of a frame in main memory. GL thread. */
#ifndef SHEEN_RENDER_GL_READBACK_H
#define SHEEN_RENDER_GL_READBACK_H

#include "server/render/view.h"
#include "server/scene/frame.h"

struct gl_renderer;

/* Copies the requested planes of `tile`, which lies in `drawn`, from the target into the frame. */
bool readback(struct gl_renderer *r, const struct frame_request *request, const struct view *view,
              const struct tile *drawn, const struct tile *tile, struct frame *frame,
              struct error *error);

#endif
