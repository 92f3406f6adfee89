/* Chooses the planes that a frame is drawn into, and decides when a later frame of the same view
 * can use them instead of drawing. GL thread. */
#ifndef SHEEN_RENDER_GL_KEPT_H
#define SHEEN_RENDER_GL_KEPT_H

#include "server/render/gl/planes.h"

struct gl_frame;
struct gl_model;
struct gl_renderer;

/* Exchanges the planes in use with others. */
void planes_swap(struct gl_renderer *r, struct planes *others);
/* Chooses the planes for a frame's next tile. If, at the first tile, some planes already hold the
 * frame's view, they are used, and own->tile becomes the frame's size: only stage 3 is left, in one
 * tile. */
void planes_choose(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own);
/* Call it before a tile is drawn into PLANES_TILED: their contents are lost, unless they are this
 * frame's. */
void collect_begin(struct gl_renderer *r, const struct gl_frame *own);
/* Call it after a tile: appends the lists of PLANES_APART, with `edges` also those at edges, to the
 * lists of the tiles before. */
void collect_tile(struct gl_renderer *r, bool edges);
/* Call it after the last tile: keeps the planes if all tiles were collected. */
void collect_end(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request);
/* Call it after a frame in one tile: keeps the planes. */
void planes_keep(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request);

/* Frees all planes: no view is kept. */
void planes_drop(struct gl_renderer *r);
/* The device memory of all planes, bytes. */
uint64_t planes_bytes(const struct gl_renderer *r);

#endif
