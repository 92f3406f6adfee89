/* Images in and out, and text, through OpenImageIO, behind a C header: the one file that includes
 * OpenImageIO is image.cpp, and sheend itself is not linked with it; its worker process
 * sheend-image is. What holds and checks results is in pixels.c and known to both. Thread: every
 * function may be called from any thread, on different data. */
#ifndef SHEEN_IMAGE_IMAGE_H
#define SHEEN_IMAGE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

/* Of decoded pixels: a small file can hold many. */
#define IMAGE_MAX_BYTES (1024ull * 1024 * 1024)
/* Width and height of a file written. */
#define IMAGE_MAX_PX (1u << 20)

/* A decoded light image: RGBA, top row first, rows contiguous. Files of integers are read as
 * sRGB-encoded, files of floats as linear light. Owned by the caller; free with image_finish(). */
struct image {
    uint32_t width_px, height_px;
    bool is_float; /* pixels are float[4], linear light, premultiplied by alpha: the file has more
                      than 8 bits or is transparent; else uint8_t[4], sRGB-encoded and opaque */
    void *pixels;
};

/* What image_decode() takes, told by the first bytes. */
#define IMAGE_READ_FORMATS "PNG, JPEG, TIFF, OpenEXR, HDR, GIF, BMP, TGA, WebP, PNM"

/* Decodes one of IMAGE_READ_FORMATS. Grey becomes RGB, missing alpha becomes 1. Refuses images
 * wider or higher than max_px or over IMAGE_MAX_BYTES (named in the error). `name` stands in
 * messages; it opens nothing and tells nothing. NaN becomes 0. On failure *image is empty:
 * ERROR_IMAGE, or ERROR_SERVER when memory is short. */
bool image_decode(struct image *image, const void *bytes, size_t size, const char *name,
                  uint32_t max_px, struct error *error);
void image_finish(struct image *image);

/* What every decoded image keeps to: sides from 1 to max_px, at most IMAGE_MAX_BYTES, pixels there
 * and finite. ERROR_IMAGE, saying `name`. */
bool image_check(const struct image *image, const char *name, uint32_t max_px, struct error *error);
size_t image_bytes(const struct image *image); /* of its pixels; the sides are at most 2^20 */

/* OpenImageIO from now on starts no thread of its own. Before its first use, and for good. */
void image_use_one_thread(void);

enum image_type { IMAGE_UINT8, IMAGE_FLOAT, IMAGE_UINT32 };

/* One channel of an image to be written: name as in EXR ("R", "P.X", "ptex.face"), samples at
 * data + y * row_stride_bytes + x * pixel_stride_bytes, top row first. Not owned. */
struct image_channel {
    const char *name;
    enum image_type type;
    const void *data;
    size_t pixel_stride_bytes;
    size_t row_stride_bytes;
};

/* A text attribute that goes into PNG text chunks, EXR attributes, TIFF's description or a JPEG
 * file's comment. */
struct image_attribute {
    const char *name;
    const char *value;
};

enum image_format { IMAGE_EXR, IMAGE_TIFF };

/* Encodes to a malloc'd buffer that the caller frees. TIFF takes the UINT8 channels R G B
 * A only; EXR takes any mix of types, UINT8 colour written as HALF in [0,1]. The same input gives
 * the same bytes: no clock, host or path is written. A plane that the format cannot hold is
 * ERROR_REQUEST. */
bool image_encode(enum image_format format, uint32_t width_px, uint32_t height_px,
                  const struct image_channel *channels, size_t n_channels,
                  const struct image_attribute *attributes, size_t n_attributes, uint8_t **bytes,
                  size_t *size, struct error *error);

/* A line of text as a mask: its baseline begins at (0, 0), y goes down. Owned by the caller; free
 * with text_finish(). */
struct text {
    int left_px, top_px; /* of the mask's first pixel */
    uint32_t width_px, height_px;
    float *coverage; /* [height_px][width_px], 0 to 1 */
};
/* Sides of a mask, and its distance from the baseline's begin. */
#define TEXT_MAX_PX (1u << 15)

/* One line of ASCII (OpenImageIO 2.4 misreads more) in DejaVu Sans of size_px. On failure *text is
 * empty: ERROR_SERVER when the font or memory is missing. */
bool text_create(struct text *text, const char *line, int size_px, struct error *error);
void text_finish(struct text *text);
/* True if sides and distances are within TEXT_MAX_PX and `coverage` is set, from 0 to 1. */
bool text_check(const struct text *text);

enum text_align { TEXT_LEFT, TEXT_CENTRE, TEXT_RIGHT };

/* Writes text over 8-bit RGBA pixels (straight alpha, rows contiguous, top first): its baseline
 * begins, has its middle or ends at (x_px, y_px). What lies outside of the picture is left out. */
void text_draw(const struct text *text, uint8_t *rgba, uint32_t width_px, uint32_t height_px,
               int x_px, int y_px, enum text_align align, const float colour[4]);

#endif
