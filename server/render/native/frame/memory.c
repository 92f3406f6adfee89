#include "server/render/native/frame/memory.h"

#include "server/render/native/device_internal.h"

/* A target of this size, with its groups and the rays of rounded pixels, which are few whatever their
 * most. */
static uint64_t target_bytes(const struct renderer_frame_size *size, const struct tile_size *target)
{
    enum { PX_PER_ROUNDED = 16, RAY_WORDS = NATIVE_MAX_RAYS * HIT_WORDS };
    const uint64_t px = (uint64_t)target->width * target->height;
    const uint64_t words = WORDS_PER_PX + (size->several_lights ? LIGHT_WORDS_PER_PX : 0) +
                           (size->measures ? MEASURE_WORDS_PER_PX : 0) + RAY_WORDS / PX_PER_ROUNDED;
    return (px * words + 2 * px / (GROUP_WIDTH * GROUP_HEIGHT)) * sizeof(uint32_t);
}

/* A frame in several tiles in place has a target for all of them beside that of a tile. */
uint64_t native_frame_bytes(const struct renderer_frame_size *size)
{
    const struct tile_size whole = {size->width_px, size->height_px};
    const struct tile_size tile =
        tiles_cut(size->width_px, size->height_px, size->tile_px, size->in_place);
    if (tile.width == whole.width && tile.height == whole.height)
        return target_bytes(size, &whole);
    const struct tile_size drawn = tile_size_with_margin(&tile, size->width_px, size->height_px);
    return target_bytes(size, &drawn) + (size->in_place ? target_bytes(size, &whole) : 0);
}

static uint64_t held_by(const struct native_target *target)
{
    return (target->own.n + target->of_lights.n + target->of_measures.n + target->n_hit_words) *
           sizeof(uint32_t);
}

struct renderer_held native_frame_held(const struct renderer *renderer)
{
    const struct native_renderer *r = (const struct native_renderer *)(const void *)renderer;
    uint64_t bytes = 0;
    for (int i = 0; i < NATIVE_PLANES; i++)
        bytes += held_by(&r->planes[i].target);
    return (struct renderer_held){.frames = bytes};
}

void native_frame_drop_held(struct renderer *renderer)
{
    struct native_renderer *r = native_renderer_of(renderer);
    for (int i = 0; i < NATIVE_PLANES; i++) {
        native_target_finish(&r->planes[i].target);
        r->planes[i].kept = (struct kept_view){0};
    }
    r->collecting = 0;
}

uint64_t native_frame_paused_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px)
{
    const struct tile_size tile = tiles_cut(width_px, height_px, tile_px, false);
    const struct tile_size drawn = tile_size_with_margin(&tile, width_px, height_px);
    return native_seen_bytes(drawn.width, drawn.height);
}
