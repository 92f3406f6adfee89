/* The state of a frame on the native device between its steps. Internal to the folder. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_STATE_H
#define SHEEN_RENDER_NATIVE_FRAME_STATE_H

#include "server/base/block_cache.h"
#include "server/render/native/device_internal.h"

struct native_frame_state {
    struct frame_state base;
    struct block_cache *block_cache;
    uint64_t serial; /* serial number of the frame */
    uint32_t x, y;   /* of the next tile, px */
    struct tile_size tile;
    /* Polygons: the mesh, which the frame holds, and the drawn part of the tile. */
    struct renderer_polygons *polygons;
    struct native_seen_triangles seen;
    size_t part; /* the next part of the mesh to draw */
};

#endif
