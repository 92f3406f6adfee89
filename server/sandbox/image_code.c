#include "server/sandbox/image_code.h"

#include <stdlib.h>
#include <string.h>

/* --- images */

void image_size_write(struct sink *sink, const struct image *size)
{
    sink_u32(sink, size->width_px);
    sink_u32(sink, size->height_px);
    sink_u32(sink, size->is_float);
}

void image_write(struct sink *sink, const struct image *image)
{
    image_size_write(sink, image);
    sink_bytes(sink, image->pixels, image_bytes(image));
}

/* The sides may be 0, but are so small that image_bytes() cannot overflow. */
static bool take_size(struct source *source, struct image *taken)
{
    *taken = (struct image){0};
    taken->width_px = source_u32(source);
    taken->height_px = source_u32(source);
    const uint32_t is_float = source_u32(source);
    taken->is_float = is_float != 0;
    return source->ok && is_float <= 1 && taken->width_px <= IMAGE_MAX_PX &&
           taken->height_px <= IMAGE_MAX_PX;
}

bool image_size_take(struct source *source, struct image *size, const char *name, uint32_t max_px,
                     struct error *error)
{
    return (take_size(source, size) && source->left == 0 && size->width_px > 0 &&
            size->height_px > 0 && size->width_px <= max_px && size->height_px <= max_px &&
            image_bytes(size) <= IMAGE_MAX_BYTES) ||
           error_set(error, ERROR_IMAGE, "%s: the process that measured it handed back no size",
                     name);
}

bool image_take(struct source *source, struct image *image, const char *name, uint32_t max_px,
                struct error *error)
{
    struct image taken;
    *image = (struct image){0};
    if (!take_size(source, &taken) || source->left != image_bytes(&taken))
        return error_set(error, ERROR_IMAGE, "%s: the process that read it handed back no image",
                         name);
    const size_t size = source->left;
    taken.pixels = malloc(size > 0 ? size : 1);
    if (!taken.pixels)
        return error_set(error, ERROR_SERVER, "%s: no memory for %u x %u pixels: try again later",
                         name, taken.width_px, taken.height_px);
    memcpy(taken.pixels, source_bytes(source, size), size);
    if (!image_check(&taken, name, max_px, error)) {
        image_finish(&taken);
        return false;
    }
    *image = taken;
    return true;
}

/* --- pictures: sizes, attributes, blocks, then the channels, each with the number of its block */

void picture_write(struct sink *sink, const struct picture *picture,
                   const struct picture_block *blocks, size_t n_blocks)
{
    sink_u32(sink, (uint32_t)picture->format);
    sink_u32(sink, picture->width_px);
    sink_u32(sink, picture->height_px);
    sink_u32(sink, (uint32_t)picture->n_attributes);
    for (size_t i = 0; i < picture->n_attributes; i++) {
        sink_text(sink, picture->attributes[i].name);
        sink_text(sink, picture->attributes[i].value);
    }
    sink_u32(sink, (uint32_t)n_blocks);
    for (size_t i = 0; i < n_blocks; i++) {
        sink_u64(sink, blocks[i].size);
        sink_bytes(sink, blocks[i].bytes, blocks[i].size);
    }
    sink_u32(sink, (uint32_t)picture->n_channels);
    for (size_t i = 0; i < picture->n_channels; i++) {
        const struct image_channel *channel = &picture->channels[i];
        uintptr_t at = (uintptr_t)channel->data;
        uint32_t block = 0;
        while (at - (uintptr_t)blocks[block].bytes >= blocks[block].size)
            block++;
        sink_text(sink, channel->name);
        sink_u32(sink, (uint32_t)channel->type);
        sink_u32(sink, block);
        sink_u64(sink, at - (uintptr_t)blocks[block].bytes);
        sink_u64(sink, channel->pixel_stride_bytes);
        sink_u64(sink, channel->row_stride_bytes);
    }
}

/* The number of bytes from the first to the last byte of a channel. False on overflow. */
static bool measure_channel(const struct picture *picture, const struct image_channel *channel,
                            size_t *size)
{
    size_t columns, rows;
    return !__builtin_mul_overflow(picture->width_px - 1, channel->pixel_stride_bytes, &columns) &&
           !__builtin_mul_overflow(picture->height_px - 1, channel->row_stride_bytes, &rows) &&
           !__builtin_add_overflow(columns, rows, size) &&
           !__builtin_add_overflow(*size, channel->type == IMAGE_UINT8 ? 1 : 4, size);
}

static bool take_channel(struct source *source, const struct picture *picture,
                         const struct picture_block *blocks, size_t n_blocks,
                         struct image_channel *channel)
{
    size_t size;
    channel->name = source_text(source);
    const uint32_t type = source_u32(source), block = source_u32(source);
    const uint64_t offset = source_u64(source);
    channel->pixel_stride_bytes = source_u64(source);
    channel->row_stride_bytes = source_u64(source);
    if (!source->ok || type > IMAGE_UINT32 || block >= n_blocks)
        return false;
    channel->type = (enum image_type)type;
    if (!measure_channel(picture, channel, &size) || offset > blocks[block].size ||
        size > blocks[block].size - offset)
        return false;
    channel->data = (const uint8_t *)blocks[block].bytes + offset;
    return true;
}

bool picture_take(struct source *source, struct picture *picture)
{
    struct picture_block blocks[PICTURE_MAX_CHANNELS];
    const uint32_t format = source_u32(source);
    picture->format = (enum image_format)format;
    picture->width_px = source_u32(source);
    picture->height_px = source_u32(source);
    picture->n_attributes = source_u32(source);
    if (format > IMAGE_TIFF || picture->width_px == 0 || picture->height_px == 0 ||
        picture->n_attributes > PICTURE_MAX_ATTRIBUTES)
        return false;
    for (size_t i = 0; i < picture->n_attributes; i++) {
        picture->attributes[i].name = source_text(source);
        picture->attributes[i].value = source_text(source);
    }
    const uint32_t n_blocks = source_u32(source);
    if (n_blocks > PICTURE_MAX_CHANNELS)
        return false;
    for (uint32_t i = 0; i < n_blocks; i++) {
        blocks[i].size = source_u64(source);
        blocks[i].bytes = source_bytes(source, blocks[i].size);
    }
    picture->n_channels = source_u32(source);
    if (!source->ok || picture->n_channels > PICTURE_MAX_CHANNELS)
        return false;
    for (size_t i = 0; i < picture->n_channels; i++)
        if (!take_channel(source, picture, blocks, n_blocks, &picture->channels[i]))
            return false;
    return source->left == 0;
}
