#include "server/scene/frame.h"

size_t frame_plane_bytes(enum frame_plane plane)
{
    switch (plane) {
    case PLANE_COLOUR:
    case PLANE_COVERAGE:
        return 4;
    case PLANE_POSITION:
    case PLANE_NORMAL:
    case PLANE_PTEX:
        return 12;
    case PLANE_LIGHT:
    case PLANE_CURVATURE:
        return 8;
    case PLANE_LIGHT_CHANGE:
        return 16;
    }
    return 0;
}

bool frame_init(struct frame *frame, const struct frame_request *request,
                struct block_cache *block_cache, struct error *error)
{
    *frame = (struct frame){
        .width_px = request->width_px, .height_px = request->height_px, .block_cache = block_cache};
    size_t pixels = (size_t)request->width_px * request->height_px;
    for (int p = 0; p < PLANE_COUNT; p++) {
        if (!(request->planes & 1u << p))
            continue;
        size_t bytes = pixels * frame_plane_bytes((enum frame_plane)(1 << p));
        frame->plane[p] = block_cache_take(block_cache, bytes);
        if (!frame->plane[p]) {
            frame_finish(frame);
            return error_set(error, ERROR_SERVER,
                             "out of memory: a plane of a %ux%u frame needs %zu bytes",
                             request->width_px, request->height_px, bytes);
        }
    }
    return true;
}

void frame_finish(struct frame *frame)
{
    for (int p = 0; p < PLANE_COUNT; p++)
        block_cache_give(frame->block_cache, frame->plane[p]);
    *frame = (struct frame){0};
}
