/* Stage 1: draws the grids of the chosen parts of the surface into the visibility buffer. GL
 * thread. */
#ifndef SHEEN_RENDER_GL_VISIBILITY_H
#define SHEEN_RENDER_GL_VISIBILITY_H

#include "server/base/error.h"
#include "server/render/gl/stages.h"
#include "server/render/patch_grids.h"

struct gl_model;
struct gl_renderer;
struct table_programs;

bool stage_visibility_init(struct visibility_stage *stage, struct error *error);
/* Draws r->grids for the tile that the view block in r->view_buffer describes. */
void stage_visibility(struct gl_renderer *r, const struct gl_model *model,
                      const struct table_programs *programs);

/* From here on draws into a framebuffer that stands for `place` of the picture, but only inside of
 * `drawn`; the nearest wins, by reversed depth. */
void raster_begin(GLuint framebuffer, const struct tile *place, const struct tile *drawn);

#endif
