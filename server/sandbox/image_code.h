/* Serialises images, pictures and texts between the daemon and its worker. Everything that is read
 * is checked; pointers in the result point into the source's bytes only. Any thread. */
#ifndef SHEEN_SANDBOX_IMAGE_CODE_H
#define SHEEN_SANDBOX_IMAGE_CODE_H

#include "server/image/image.h"
#include "server/sandbox/stream.h"

/* A decoded image. image_take() copies the pixels and checks them by image_check(); max_px is the
 * largest side. On success the caller owns the image. On failure *image is empty; ERROR_IMAGE, or
 * ERROR_SERVER when memory is short. `name` is the file's name for the error. */
/* The size of an image without its pixels, before them. image_size_take() checks that sides are from 1 to
 * max_px and that pixels take at most IMAGE_MAX_BYTES. */
void image_size_write(struct sink *sink, const struct image *size);
bool image_size_take(struct source *source, struct image *size, const char *name, uint32_t max_px,
                     struct error *error);
void image_write(struct sink *sink, const struct image *image);
bool image_take(struct source *source, struct image *image, const char *name, uint32_t max_px,
                struct error *error);

#define PICTURE_MAX_CHANNELS 32
#define PICTURE_MAX_ATTRIBUTES 32

/* The input of image_encode(): channels that lie in a few blocks of memory, which they share. */
struct picture_block {
    const void *bytes;
    size_t size;
};
struct picture {
    enum image_format format;
    uint32_t width_px, height_px;
    size_t n_channels, n_attributes;
    struct image_channel channels[PICTURE_MAX_CHANNELS];
    struct image_attribute attributes[PICTURE_MAX_ATTRIBUTES];
};

/* Writes a picture. Each channel must lie in one of the blocks. */
void picture_write(struct sink *sink, const struct picture *picture,
                   const struct picture_block *blocks, size_t n_blocks);
/* Reads a picture, whose pointers point into the source's bytes. False if it is malformed: then do
 * not read its channels. */
bool picture_take(struct source *source, struct picture *picture);

#endif
