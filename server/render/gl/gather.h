/* Which pixels the passes after stage 1 run over (shaders/groups.glsl). GL thread. */
#ifndef SHEEN_RENDER_GL_GATHER_H
#define SHEEN_RENDER_GL_GATHER_H

#include <stdbool.h>

#include "server/base/error.h"
#include "server/render/gl/stages.h"

struct gl_renderer;

bool stage_gather_init(struct gather_stage *stage, struct error *error);
/* After stage 1 or polygons: lists the pixels near what is seen, target.groups, over which
 * dispatch_groups() runs a program; and those that may have to ask their neighbours,
 * target.discontinuous. Planes that it writes must be cleared before: it leaves gaps. */
void stage_gather(struct gl_renderer *r);
/* Has stage_gather() found a pixel in the tile that was drawn last? Waits for the device. */
bool gather_found_any(const struct gl_renderer *r);
void dispatch_groups(GLuint program, GLuint groups);

#endif
