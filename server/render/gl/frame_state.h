/* The state of a frame on this device between two steps. Data for frame.h. GL thread. */
#ifndef SHEEN_RENDER_GL_FRAME_STATE_H
#define SHEEN_RENDER_GL_FRAME_STATE_H

#include "server/render/device.h"
#include "server/render/gl/programs/kept_programs.h"
#include "server/render/tiles.h"

struct paused_tile;

/* The stages of a tile of polygons. */
enum tile_stage { TILE_FILL, TILE_SHADE, TILE_EDGES, TILE_WHOLE };

struct gl_frame {
    struct frame_state base;
    struct block_cache *block_cache; /* memory of this struct */
    const struct frame_work *work;   /* valid during a step */
    uint64_t serial;                 /* serial number of the frame */
    struct tile_size tile;
    uint32_t x, y;              /* of the next tile, px */
    enum tile_stage stage;      /* polygons: the next stage of the tile */
    size_t part;                /* polygons: the next part of the mesh in that stage */
    struct program_hold hold;   /* the programs of its tile */
    struct paused_tile *paused; /* the drawn part of its tile; NULL: nothing */
};

static inline struct gl_frame *gl_frame_of(const struct frame_work *work)
{
    return (struct gl_frame *)(void *)work->state;
}

#endif
