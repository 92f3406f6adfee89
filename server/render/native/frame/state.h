/* What the native device keeps of a frame between its steps. Internal to the folder. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_STATE_H
#define SHEEN_RENDER_NATIVE_FRAME_STATE_H

#include "server/base/block_cache.h"
#include "server/render/native/device_internal.h"

struct native_frame_state {
    struct frame_state base;
    struct block_cache *block_cache;
    uint64_t serial; /* of all frames begun */
    uint32_t x, y;   /* of the next tile */
    struct tile_size tile;
    /* Of polygons: their mesh, which the frame holds, and what has been drawn of the tile. */
    struct renderer_polygons *polygons;
    struct native_seen_triangles seen;
    size_t part; /* of the mesh, the next one to be drawn */
};

#endif
