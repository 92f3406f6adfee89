/* Stage 2: the pixel's ray against the limit surface, in passes over fewer and fewer pixels. GL
 * thread. */
#ifndef SHEEN_RENDER_GL_EVALUATE_H
#define SHEEN_RENDER_GL_EVALUATE_H

#include <epoxy/gl.h>

#include "server/base/error.h"
#include "server/render/view.h"

struct gl_model;
struct gl_renderer;
struct table_programs;

struct evaluate_stage {
    GLuint doubt, gaps;           /* programs */
    GLuint gap_ends, gap_guesses; /* buffers: shaders/unsolved.comp.glsl */
    bool too_many_gaps; /* the last tile drawn has more than MAX_GAPS, so all of them stay empty */
};

/* Pixels whose ray passes between two silhouettes (shaders/gaps.comp.glsl), of one tile: each takes
 * the processor 0.03 to 2 ms, and few pictures have more than two or three. */
enum { MAX_GAPS = 512 };

bool stage_evaluate_init(struct evaluate_stage *stage, struct error *error);
/* On the tile that the view block in r->view_buffer describes. */
void stage_evaluate(struct gl_renderer *r, const struct gl_model *model,
                    const struct table_programs *programs);
/* After it: the pixels of which stage 1 has seen nothing but triangles beyond silhouettes. Waits
 * for the device. Errors as patch_grids_choose(). */
bool stage_gaps(struct gl_renderer *r, const struct gl_model *model,
                const struct table_programs *programs, const struct view *view,
                struct error *error);
/* After stage_edges(): where the surface that its pixels show ends at silhouettes. */
void stage_silhouette(struct gl_renderer *r, const struct gl_model *model,
                      const struct table_programs *programs);
/* After stage_edges_doubt(): the rays of the pixels that show the rounding of a crease, against the
 * surface. */
void stage_rounded(struct gl_renderer *r, const struct gl_model *model,
                   const struct table_programs *programs);

#endif
