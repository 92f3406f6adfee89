/* Which planes a frame is drawn into, and when a later frame of the same view takes them instead of drawing. Internal to
 * the folder; the thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_KEPT_H
#define SHEEN_RENDER_NATIVE_FRAME_KEPT_H

#include "server/render/native/frame/state.h"
#include "server/render/native/stages.h"

/* Chooses the planes of a frame's next tile. *is_kept_view: they hold its view already; then the frame has stage 3 alone
 * left, in one tile, which own->tile is made. */
struct native_view_planes *native_planes_choose(struct native_renderer *r,
                                                struct native_frame_state *own,
                                                const struct native_shown *shown,
                                                const struct frame_work *work, bool *is_kept_view);
/* After a tile, drawn into these planes, that is not a kept view. A frame of one tile is kept in its planes; of one in tiles in_place each tile's
 * planes and lists join those of the picture, which are kept after the last tile if no other such frame came in between.
 * ERROR_SERVER when memory is short. */
bool native_planes_keep(struct native_renderer *r, const struct native_frame_state *own,
                        struct native_view_planes *planes, const struct native_drawing *drawing,
                        const struct frame_work *work, struct error *error);

#endif
