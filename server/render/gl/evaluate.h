/* Stage 2: intersects each pixel's ray with the limit surface, in passes over fewer and fewer
 * pixels. GL thread. */
#ifndef SHEEN_RENDER_GL_EVALUATE_H
#define SHEEN_RENDER_GL_EVALUATE_H

#include "server/base/error.h"
#include "server/render/gl/stages.h"
#include "server/render/view.h"

struct gl_model;
struct gl_renderer;
struct table_programs;

/* The largest number of pixels of a tile whose ray passes between two silhouettes
 * (shaders/gaps.comp.glsl). Each takes the processor 0.03 to 2 ms, and few pictures have more than
 * two or three. */
enum { MAX_GAPS = 512 };

bool stage_evaluate_init(struct evaluate_stage *stage, struct error *error);
/* Evaluates the tile that the view block in r->view_buffer describes. */
void stage_evaluate(struct gl_renderer *r, const struct gl_model *model,
                    const struct table_programs *programs);
/* After stage_evaluate(): solves the pixels in gaps, where stage 1 drew only triangles beyond
 * silhouettes. Waits for the device. Errors as patch_grids_choose(). */
bool stage_gaps(struct gl_renderer *r, const struct gl_model *model,
                const struct table_programs *programs, const struct view *view,
                struct error *error);
/* After stage_edges(): finds where the surface of the listed pixels ends. */
void stage_ends(struct gl_renderer *r, const struct gl_model *model,
                const struct table_programs *programs);
/* After stage_edges_recheck(): intersects 16 rays of each pixel that shows the rounding of a crease
 * with the surface. */
void stage_rounded(struct gl_renderer *r, const struct gl_model *model,
                   const struct table_programs *programs);

#endif
