/* Chooses the planes that a frame is drawn into, and decides when a later frame of the same view uses them instead of
 * drawing. Internal to the folder; the thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_KEPT_H
#define SHEEN_RENDER_NATIVE_FRAME_KEPT_H

#include "server/render/native/frame/state.h"
#include "server/render/native/stages.h"

/* Chooses the planes for a frame's next tile. *is_kept_view: they already hold its view; then only stage 3 is left,
 * in one tile: own->tile becomes the frame's size. */
struct native_view_planes *native_planes_choose(struct native_renderer *r,
                                                struct native_frame_state *own,
                                                const struct native_shown *shown,
                                                const struct frame_work *work, bool *is_kept_view);
/* Call it after a tile was drawn into these planes. A frame in one tile is kept in its planes. For a frame in tiles
 * in_place, planes and lists of each tile are added to those of the picture, which are kept after the last tile if no
 * other such frame came in between. False with ERROR_SERVER when memory is short. */
bool native_planes_keep(struct native_renderer *r, const struct native_frame_state *own,
                        struct native_view_planes *planes, const struct native_drawing *drawing,
                        const struct frame_work *work, struct error *error);

#endif
