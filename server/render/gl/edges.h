/* Finds the pixels through which edges of the surface pass (shaders/edges.glsl), for requests with
 * coverage. GL thread. */
#ifndef SHEEN_RENDER_GL_EDGES_H
#define SHEEN_RENDER_GL_EDGES_H

#include "server/base/error.h"
#include "server/render/gl/stages.h"
#include "server/render/tiles.h"

struct gl_renderer;

bool stage_edges_init(struct edges_stage *stage, struct error *error);
/* After stage 2: lists the pixels of a part of the target that stage 3 must look at more closely,
 * and writes the coverage of all other pixels there. Around that part it also lists, in
 * `retry_pixels`, pixels whose silhouettes are needed, and uses `unsolved` for pixels at edges;
 * stage 2 no longer needs these two lists. */
void stage_edges(struct gl_renderer *r, const struct tile *shaded);
/* After stage_ends(): the pixels at edges become the list `edges`, except those whose edges do not
 * agree with the pixels around, which become `rounded`. */
void stage_edges_recheck(struct gl_renderer *r);

#endif
