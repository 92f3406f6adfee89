/* Tiles of polygons that have been drawn in part: their planes are set aside while other frames are
 * drawn, so that the picture is that of one stroke. GL thread, where nothing else is said. */
#ifndef SHEEN_RENDER_GL_PAUSED_TILES_H
#define SHEEN_RENDER_GL_PAUSED_TILES_H

#include <stdbool.h>

#include "server/base/error.h"

struct gl_frame;
struct gl_model;
struct gl_renderer;
struct paused_tiles;
struct polygon_mesh;

/* NULL when memory is short. Released once by the renderer, any thread. */
struct paused_tiles *paused_tiles_create(void);
void paused_tiles_release(struct paused_tiles *set);
/* Takes into use what the frame has drawn of its tile, if anything. */
void tile_resume(struct gl_renderer *r, struct gl_frame *own);
/* Keeps what is drawn until the frame's next step: others may use the planes meanwhile. */
bool tile_pause(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                struct error *error);
/* Gives the planes back: the frame needs what it has drawn no longer. Any thread. */
void tile_give_back(struct gl_frame *own);
/* Is a frame under way that is drawn of this mesh? */
bool mesh_is_needed(const struct gl_renderer *r, const struct polygon_mesh *mesh);

#endif
