/* How far a frame has come on this device, between two of its steps. Data; frame.h draws it. GL
 * thread. */
#ifndef SHEEN_RENDER_GL_FRAME_STATE_H
#define SHEEN_RENDER_GL_FRAME_STATE_H

#include "server/render/device.h"
#include "server/render/tiles.h"

struct paused_tile;

/* What a tile of polygons goes through. */
enum tile_stage { TILE_FILL, TILE_SHADE, TILE_EDGES, TILE_WHOLE };

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

#endif
