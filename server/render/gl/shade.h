/* Stage 3: computes the reflected lights. GL thread. */
#ifndef SHEEN_RENDER_GL_SHADE_H
#define SHEEN_RENDER_GL_SHADE_H

#include "server/base/error.h"
#include "server/render/gl/programs/sources.h"
#include "server/render/gl/stages.h"
#include "server/render/gl/target.h"
#include "server/scene/frame.h"

struct gl_renderer;

bool stage_shade_init(struct shade_stage *stage, struct error *error);
/* Writes the ids of the programs that the frame needs, at most 5 * MAX_LIGHTS + 1. Returns their
 * number. */
int stage_shade_programs(const struct frame_request *request, struct program_id *ids);
/* Runs one of these programs, which are held, for the first time, over no pixel, for the current
 * target. *has_run_all: there was none left to run. */
void stage_shade_first_run(struct gl_renderer *r, const struct frame_request *request,
                           bool *has_run_all);
bool stage_shade(struct gl_renderer *r, const struct frame_request *request, struct error *error);
/* After stage_shade(): adds the tile's numbers to frame.seen_px and met_px. */
void shade_read_share(const struct gl_renderer *r, const struct frame_request *request,
                      bool any_seen, struct frame *frame);

/* A buffer: an indirect dispatch of zero groups. */
GLuint shade_no_groups(void);
/* A texture of one white texel, for patterns without an image. */
GLuint shade_blank_texture(void);

/* Binds a light's image. */
void shade_bind_picture(GLuint texture, const struct frame_request *request,
                        const struct light *light);
/* Runs a program over no pixel, with the same kinds of textures and images bound as when it runs
 * over pixels; the caller has bound the picture. Any context. */
void shade_run_over_nothing(const struct target *target, GLuint no_groups, enum shaded which,
                            GLuint program);

/* Clears the pixels of a plane that stage 3 will write. */
void clear_shaded(const struct gl_renderer *r, GLuint texture, GLenum format, const GLfloat *texel);

#endif
