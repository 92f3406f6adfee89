/* Which pixels edges of the surface run through (shaders/edges.glsl), for requests that have
 * coverage. GL thread. */
#ifndef SHEEN_RENDER_GL_EDGES_H
#define SHEEN_RENDER_GL_EDGES_H

#include "server/base/error.h"
#include "server/render/gl/stages.h"
#include "server/render/tiles.h"

struct gl_renderer;

bool stage_edges_init(struct edges_stage *stage, struct error *error);
/* After stage 2, lists the pixels of a part of the target that stage 3 looks at more closely, and
 * writes the coverage of all others there. Around that part it lists those, too, that silhouettes
 * are wanted of, in the list `retry_pixels` that stage 2 is done with, as it is with `unsolved`,
 * which gets those at edges. */
void stage_edges(struct gl_renderer *r, const struct tile *shaded);
/* After stage_ends(): the pixels at edges become the list `edges`, except that those whose
 * edges do not agree with what the pixels around show go to `rounded`. */
void stage_edges_recheck(struct gl_renderer *r);

#endif
