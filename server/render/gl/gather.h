/* Lists the pixels over which the passes after stage 1 run (shaders/groups.glsl). GL thread. */
#ifndef SHEEN_RENDER_GL_GATHER_H
#define SHEEN_RENDER_GL_GATHER_H

#include <stdbool.h>

#include "server/base/error.h"
#include "server/render/gl/stages.h"

struct gl_renderer;

bool stage_gather_init(struct gather_stage *stage, struct error *error);
/* After stage 1 or polygons: lists the pixels near visible surface (target.groups), over which
 * dispatch_groups() runs a program, and those that may have to ask their neighbours
 * (target.discontinuous). The planes that it writes must be cleared before, because it does not
 * write all pixels. */
void stage_gather(struct gl_renderer *r);
/* True if stage_gather() found a pixel in the last tile. Waits for the device. */
bool gather_found_any(const struct gl_renderer *r);
void dispatch_groups(GLuint program, GLuint groups);

#endif
