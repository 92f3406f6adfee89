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

/* Creates the set, for the renderer; NULL when memory is short. The set counts its holders: the
 * renderer, which calls paused_tiles_release() once, and each paused tile, until tile_give_back().
 * The last holder frees it, so that a frame may give its tile back after the renderer is destroyed.
 * Any thread. */
struct paused_tiles *paused_tiles_create(void);
void paused_tiles_release(struct paused_tiles *set);
/* Takes into use the planes with the drawn part of the frame's tile. If nothing is drawn of the tile
 * yet, or what was drawn was lost with the device, the tile begins from its start. */
void tile_resume(struct gl_renderer *r, struct gl_frame *own);
/* Sets the drawn part aside until the frame's next step; other frames may use the planes in use.
 * False with ERROR_SERVER if MAX_PAUSED_TILES other frames have a part set aside: the drawn part is
 * then not kept, and the frame fails. */
bool tile_pause(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                struct error *error);
/* Releases the planes, because the frame needs the drawn part no longer. Any thread. */
void tile_give_back(struct gl_frame *own);
/* True if a frame in progress is drawn from this mesh. */
bool mesh_is_needed(const struct gl_renderer *r, const struct polygon_mesh *mesh);

#endif
