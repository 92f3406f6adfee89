/* Pixels, planes and texts on their way between the daemon and its worker. What is taken out of a
 * source is checked and points into nothing but the source. Any thread. */
#ifndef SHEEN_SANDBOX_IMAGE_CODE_H
#define SHEEN_SANDBOX_IMAGE_CODE_H

#include "server/image/image.h"
#include "server/sandbox/stream.h"

/* A decoded image. It is copied and passes image_check(). On failure *image is empty: ERROR_IMAGE,
 * or ERROR_SERVER when memory is short; the text says `name`. */
void image_write(struct sink *sink, const struct image *image);
bool image_take(struct source *source, struct image *image, const char *name, uint32_t max_px,
                struct error *error);

#define PICTURE_MAX_CHANNELS 32
#define PICTURE_MAX_ATTRIBUTES 32

/* What image_encode() is given. Channels lie in blocks of memory that they share. */
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

/* Every channel lies in one of the blocks. */
void picture_write(struct sink *sink, const struct picture *picture,
                   const struct picture_block *blocks, size_t n_blocks);
/* False when it is none; its channels then are not to be read. */
bool picture_take(struct source *source, struct picture *picture);

/* A mask of text, which passes text_check(). It is copied to `coverage`, the caller's room for all
 * that is left of the source, to which *text refers. On failure *text is empty. */
void text_write(struct sink *sink, const struct text *text);
bool text_take(struct source *source, float *coverage, struct text *text);

#endif
