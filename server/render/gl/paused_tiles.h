/* Tiles of polygons that are drawn in part: their planes are set aside while other frames are
 * drawn, so that the picture does not depend on the interruption. GL thread, except where noted. */
#ifndef SHEEN_RENDER_GL_PAUSED_TILES_H
#define SHEEN_RENDER_GL_PAUSED_TILES_H

#include <stdbool.h>

#include "server/base/error.h"

struct gl_frame;
struct gl_model;
struct gl_renderer;
struct paused_tiles;
struct polygon_mesh;

/* Creates the set. NULL when memory is short. The renderer releases it once; any thread. */
struct paused_tiles *paused_tiles_create(void);
void paused_tiles_release(struct paused_tiles *set);
/* Takes into use the planes with the drawn part of the frame's tile, if there are any. */
void tile_resume(struct gl_renderer *r, struct gl_frame *own);
/* Sets the drawn part aside until the frame's next step; other frames may use the planes in use. */
bool tile_pause(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                struct error *error);
/* Releases the planes, because the frame needs the drawn part no longer. Any thread. */
void tile_give_back(struct gl_frame *own);
/* True if a frame in progress is drawn from this mesh. */
bool mesh_is_needed(const struct gl_renderer *r, const struct polygon_mesh *mesh);

#endif
