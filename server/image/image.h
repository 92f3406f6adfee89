/* Reads and writes images and renders text, by OpenImageIO, behind a C header. Only image.cpp
 * includes OpenImageIO, and only the worker program sheend-image is linked with it, not sheend.
 * pixels.c holds and checks results, for both.
 * Thread: any, on different data. */
#ifndef SHEEN_IMAGE_IMAGE_H
#define SHEEN_IMAGE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

/* Limit of decoded pixels, because a small file can contain many. */
#define IMAGE_MAX_BYTES (1024ull * 1024 * 1024)
/* Largest width and height of a written file. */
#define IMAGE_MAX_PX (1u << 20)

/* A decoded light image: RGBA, contiguous rows, top row first. Files with integers count as sRGB,
 * files with floats as linear light. Owned by the caller; free it by image_finish(). */
struct image {
    uint32_t width_px, height_px;
    /* Pixels are float[4], linear light, premultiplied by alpha (the file has more than 8 bits or
     * is transparent); else uint8_t[4], sRGB and opaque. */
    bool is_float;
    void *pixels;
};

/* The formats that image_decode() reads; it recognises them by the first bytes. */
#define IMAGE_READ_FORMATS "PNG, JPEG, TIFF, OpenEXR, HDR, GIF, BMP, TGA, WebP, PNM"

/* Decodes one of IMAGE_READ_FORMATS. Grey becomes RGB, missing alpha 1, NaN 0. Refuses images wider
 * or higher than max_px or larger than IMAGE_MAX_BYTES; the error names the limit. `name` is used
 * in messages only: no file is opened. On failure *image is empty; ERROR_IMAGE, or ERROR_SERVER
 * when memory is short. */
bool image_decode(struct image *image, const void *bytes, size_t size, const char *name,
                  uint32_t max_px, struct error *error);
void image_finish(struct image *image);

/* What image_decode() would give at most, from the first bytes of the file: the sides, and is_float where
 * pixels may become floats. size->pixels is NULL. The same errors, as far as the first bytes show them. */
bool image_measure(struct image *size, const void *bytes, size_t n_bytes, const char *name,
                   uint32_t max_px, struct error *error);

/* Checks what must hold for a decoded image: sides from 1 to max_px, at most IMAGE_MAX_BYTES,
 * pixels present and finite. False with ERROR_IMAGE and `name`. */
bool image_check(const struct image *image, const char *name, uint32_t max_px, struct error *error);
size_t image_bytes(const struct image *image); /* bytes of the pixels; sides are at most 2^20 */

/* From now on OpenImageIO starts no thread of its own. Call it before the first use. */
void image_use_one_thread(void);

enum image_type { IMAGE_UINT8, IMAGE_FLOAT, IMAGE_UINT32 };

/* One channel of an image to be written. The name is as in EXR ("R", "P.X", "ptex.face"). Samples
 * are at data + y * row_stride_bytes + x * pixel_stride_bytes, top row first. The memory is not
 * owned. */
struct image_channel {
    const char *name;
    enum image_type type;
    const void *data;
    size_t pixel_stride_bytes;
    size_t row_stride_bytes;
};

/* A text attribute, for PNG text chunks, EXR attributes, TIFF's description or the comment of a
 * JPEG file. */
struct image_attribute {
    const char *name;
    const char *value;
};

enum image_format { IMAGE_EXR, IMAGE_TIFF };

/* Encodes a file into a malloc'd buffer, which the caller frees. TIFF takes only the UINT8 channels
 * R, G, B, A; EXR takes any mix of types, and writes UINT8 colour as HALF in [0,1]. The same input
 * gives the same bytes: no time, host or path is written. False with ERROR_REQUEST if the format
 * cannot hold a channel. */
bool image_encode(enum image_format format, uint32_t width_px, uint32_t height_px,
                  const struct image_channel *channels, size_t n_channels,
                  const struct image_attribute *attributes, size_t n_attributes, uint8_t **bytes,
                  size_t *size, struct error *error);

#endif
