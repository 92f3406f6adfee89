/* Which planes a frame is drawn into, and when a later frame of the same view may take them instead
 * of drawing. GL thread. */
#ifndef SHEEN_RENDER_GL_KEPT_H
#define SHEEN_RENDER_GL_KEPT_H

#include "server/render/gl/planes.h"

struct gl_frame;
struct gl_model;
struct gl_renderer;

/* Do the planes hold all that stages 1 and 2 would draw for this request? */
bool is_kept(const struct kept *kept, const struct gl_model *model,
             const struct frame_request *request);
/* The planes in use change places with others. */
void planes_swap(struct gl_renderer *r, struct planes *others);
/* Takes into use the planes that a frame's next tile is drawn into. At the first tile of a frame
 * whose view some planes hold already, these are taken, and own->tile is set to the frame's size:
 * it has only stage 3 left, in one tile. */
void planes_choose(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own);
/* Before a tile is drawn into PLANES_TILED: what they hold is lost, unless it is the frame's own.
 */
void collect_begin(struct gl_renderer *r, const struct gl_frame *own);
/* After a tile: the lists of PLANES_APART join those of the tiles before, those at edges too. */
void collect_tile(struct gl_renderer *r, bool edges);
/* After the last: the planes are kept if all tiles have been collected. */
void collect_end(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request);
/* After a frame of one tile: they are kept. */
void planes_keep(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request);

#endif
