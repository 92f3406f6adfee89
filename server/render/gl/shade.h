/* Stage 3: the lights in the mirror. GL thread. */
#ifndef SHEEN_RENDER_GL_SHADE_H
#define SHEEN_RENDER_GL_SHADE_H

#include "server/base/error.h"
#include "server/render/gl/stages.h"
#include "server/scene/frame.h"

struct gl_renderer;

bool stage_shade_init(struct shade_stage *stage, struct error *error);
/* Makes one of the programs that the frame needs and that are missing. *is_ready: none was missing,
 * and all stay until the next call, for the target as it is. */
bool stage_shade_prepare(struct gl_renderer *r, const struct frame_request *request, bool *is_ready,
                         struct error *error);
bool stage_shade(struct gl_renderer *r, const struct frame_request *request, struct error *error);
/* After stage_shade(): adds to frame.seen_px and met_px what the tile has of them. */
void shade_read_share(const struct gl_renderer *r, const struct frame_request *request,
                      bool any_seen, struct frame *frame);

/* Sets a plane's pixels that stage 3 is about to write. */
void clear_shaded(const struct gl_renderer *r, GLuint texture, GLenum format, const GLfloat *texel);

#endif
