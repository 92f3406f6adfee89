/* Stage 3: computes the reflected lights. GL thread. */
#ifndef SHEEN_RENDER_GL_SHADE_H
#define SHEEN_RENDER_GL_SHADE_H

#include "server/base/error.h"
#include "server/render/gl/stages.h"
#include "server/scene/frame.h"

struct gl_renderer;

bool stage_shade_init(struct shade_stage *stage, struct error *error);
/* Makes one of the programs that the frame needs and that do not exist yet. *is_ready: all exist,
 * and stay until the next call, for the current target. */
bool stage_shade_prepare(struct gl_renderer *r, const struct frame_request *request, bool *is_ready,
                         struct error *error);
bool stage_shade(struct gl_renderer *r, const struct frame_request *request, struct error *error);
/* After stage_shade(): adds the tile's numbers to frame.seen_px and met_px. */
void shade_read_share(const struct gl_renderer *r, const struct frame_request *request,
                      bool any_seen, struct frame *frame);

/* Clears the pixels of a plane that stage 3 will write. */
void clear_shaded(const struct gl_renderer *r, GLuint texture, GLenum format, const GLfloat *texel);

#endif
