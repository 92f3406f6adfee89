/* One frame on this device: its tiles, and the three stages of each. GL thread, where nothing else
 * is said. */
#ifndef SHEEN_RENDER_GL_FRAME_H
#define SHEEN_RENDER_GL_FRAME_H

#include "server/render/device.h"
#include "server/render/gl/polygon_slices.h"
#include "server/render/tiles.h"

/* How far a frame has come, between two steps. */
struct gl_frame {
    struct frame_state base;
    struct block_cache *block_cache; /* where this struct comes from */
    const struct frame_work *work;   /* during a step */
    uint64_t serial;                 /* of all frames begun */
    struct tile_size tile;
    uint32_t x, y;              /* of the next tile */
    enum tile_stage stage;      /* of polygons: the next stage of the tile */
    size_t part;                /* of polygons: the next part of the mesh in that stage */
    unsigned n_programs;        /* made for this frame so far */
    struct paused_tile *paused; /* what is drawn of its tile; NULL: nothing */
};

static inline struct gl_frame *gl_frame_of(const struct frame_work *work)
{
    return (struct gl_frame *)(void *)work->state;
}

/* As struct renderer_device has them. */
bool gl_frame_begin(struct renderer *renderer, struct frame_work *work, struct error *error);
enum frame_step gl_frame_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error);
uint64_t gl_paused_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px);

#endif
