/* Encodes a frame's colour plane as a JPEG file with three channels. Alpha is left out. The
 * metadata become the file's comment.
 *
 * The picture is cut into horizontal strips so that several threads can encode it. Each strip is
 * first encoded as a JPEG file of its own. Without its head it is one restart interval of the whole
 * file:
 *
 *   head                 with the metadata and the height of the whole picture
 *   scans of the strips  one after another, separated by restart markers (numbered 0 to 7, cyclic)
 *
 * sheend calls libjpeg-turbo in its own process: it encodes only pixels that it has drawn itself,
 * and a worker process would cost more time than the encoding. Only jpeg.c includes libjpeg-turbo.
 * The library allocates memory for a few rows by itself. Thread: any, except where noted; an
 * encoder is used by one thread at a time. */
#ifndef SHEEN_OUTPUT_JPEG_H
#define SHEEN_OUTPUT_JPEG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/image/image.h"
#include "server/output/strips.h"

/* One sample of Cb and of Cr for each pixel; for two pixels side by side; for two by two pixels. */
enum jpeg_subsampling { JPEG_444, JPEG_422, JPEG_420 };
struct jpeg_options {
    unsigned quality; /* libjpeg's scale */
    enum jpeg_subsampling subsampling;
};
/* Without subsampling, coloured lines are as sharp as grey ones. */
#define JPEG_DEFAULTS ((struct jpeg_options){.quality = 95, .subsampling = JPEG_444})

struct jpeg_layout {
    struct strip_layout strips;
    struct jpeg_options options;
};

struct jpeg_encoder;

/* Removes the environment variables (TJ_...) that change what libjpeg-turbo writes, so that files
 * are the same everywhere. Called by the main thread before it starts other threads. */
void jpeg_keep_defaults(void);

struct jpeg_encoder *jpeg_encoder_create(void);          /* NULL when memory is short */
void jpeg_encoder_destroy(struct jpeg_encoder *encoder); /* NULL is safe */

/* Both sides of the picture are from 1 to PROTOCOL_MAX_JPEG_PX. Copies *options. */
void jpeg_layout_init(struct jpeg_layout *layout, uint32_t width_px, uint32_t height_px,
                      const struct jpeg_options *options);

/* Encodes strip `index` of the picture `rgba` (8 bits each of R, G, B, A; contiguous rows, top row
 * first) into `bytes`, which has room for layout->strips.bound. *size is the number of bytes
 * written; those before *start are the strip's own head and are not part of the file. The same
 * input gives the same bytes. On failure returns false with ERROR_SERVER and the library's reason;
 * the encoder stays usable. */
bool jpeg_strip_encode(struct jpeg_encoder *encoder, const struct jpeg_layout *layout, size_t index,
                       const uint8_t *rgba, uint8_t *bytes, size_t *start, size_t *size,
                       struct error *error);

/* The number of bytes to allocate for the head: its length rounded up by strip_head_bound().
 * `start` is that of strip 0. */
size_t jpeg_head_bound(size_t start, const struct image_attribute *attributes, size_t n_attributes);

/* Writes the file's head, made from the first `start` bytes of strip 0 (`strip`), and returns its
 * length in bytes. Each attribute is a line "name=value" of the comment. */
size_t jpeg_head_write(const struct jpeg_layout *layout, const uint8_t *strip, size_t start,
                       const struct image_attribute *attributes, size_t n_attributes,
                       uint8_t *bytes);

#endif
