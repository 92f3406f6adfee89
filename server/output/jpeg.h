/* A frame's colour as a JPEG file of three channels; alpha is left out. The metadata are the file's
 * comment.
 *
 * The picture is cut into horizontal strips, so that threads can share the work: each becomes a
 * file of its own, and without its head it is one restart interval of the whole file, which is the
 *
 *   head                with the metadata and the whole picture's height
 *   the strips' scans   back to back; the first seven end with a restart marker, and so on
 *
 * sheend does this itself: it reads its own pixels only, and a process of its own would cost more
 * than the work. libjpeg-turbo is included by jpeg.c alone. Thread: any but where it is said; an
 * encoder belongs to one at a time. The library takes memory of its own, some rows' worth. */
#ifndef SHEEN_OUTPUT_JPEG_H
#define SHEEN_OUTPUT_JPEG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/image/image.h"
#include "server/output/strips.h"

/* Of colour (Cb and Cr): one sample for each pixel, for two side by side, or for two by two. */
enum jpeg_subsampling { JPEG_444, JPEG_422, JPEG_420 };
struct jpeg_options {
    unsigned quality; /* 1 to 100, as libjpeg has it */
    enum jpeg_subsampling subsampling;
};
/* Colour lines are as sharp as grey ones. */
#define JPEG_DEFAULTS ((struct jpeg_options){.quality = 95, .subsampling = JPEG_444})

struct jpeg_layout {
    struct strip_layout strips;
    struct jpeg_options options;
};

struct jpeg_encoder;

/* libjpeg-turbo takes settings from the environment (TJ_...), and files are to be the same
 * everywhere: removes them. The main thread's, before there is another. */
void jpeg_keep_defaults(void);

struct jpeg_encoder *jpeg_encoder_create(void);          /* NULL when memory is short */
void jpeg_encoder_destroy(struct jpeg_encoder *encoder); /* NULL is safe */

/* Sides are from 1 to PROTOCOL_MAX_JPEG_PX. */
void jpeg_layout_init(struct jpeg_layout *layout, uint32_t width_px, uint32_t height_px,
                      const struct jpeg_options *options);

/* Encodes strip `index` of a picture (R, G, B, A of 8 bits, rows contiguous, top first) to `bytes`,
 * which has room for layout->strips.bound. Of the *size bytes written the file's begin at *start.
 * False: ERROR_SERVER, with the library's reason; the encoder may be used again. The same input
 * gives the same bytes. */
bool jpeg_strip_encode(struct jpeg_encoder *encoder, const struct jpeg_layout *layout, size_t index,
                       const uint8_t *rgba, uint8_t *bytes, size_t *start, size_t *size,
                       struct error *error);

/* What to allocate for the head, in bytes: strip_head_bound() of its length. `start` is the first
 * strip's. */
size_t jpeg_head_bound(size_t start, const struct image_attribute *attributes, size_t n_attributes);

/* Writes the head out of what stands before `start` in the first strip, and returns its length.
 * Each attribute is a line "name=value" of the comment. */
size_t jpeg_head_write(const struct jpeg_layout *layout, const uint8_t *strip, size_t start,
                       const struct image_attribute *attributes, size_t n_attributes,
                       uint8_t *bytes);

#endif
