/* How the file encoders cut a picture into horizontal strips, so that several threads can encode
 * it. Pure, any thread. */
#ifndef SHEEN_OUTPUT_STRIPS_H
#define SHEEN_OUTPUT_STRIPS_H

#include <stddef.h>
#include <stdint.h>

/* Strip i begins at row i * rows; the last strip has the rows that are left. */
struct strip_layout {
    uint32_t width_px, height_px;
    uint32_t rows; /* of each strip but the last */
    size_t n;      /* strips */
    size_t bound;  /* bytes to allocate for an encoded strip */
};

/* Cuts a picture into strips of about PROTOCOL_STRIP_BYTES of RGBA with 8 bits each. The number of
 * rows of a strip, except the last, is a multiple of `multiple`, which is from 1 to 16 (JPEG: the rows
 * of a block, 8 or 16; PNG: 1). Both sides are from 1 to PROTOCOL_MAX_SIZE_PX. layout->bound
 * stays 0: the encoder sets it. */
void strip_layout_init(struct strip_layout *layout, uint32_t width_px, uint32_t height_px,
                       uint32_t multiple);

/* The number of rows of a strip. */
uint32_t strip_rows(const struct strip_layout *layout, size_t index);
/* The first pixel of a strip; `rgba` is the whole picture, its rows contiguous, top first. */
const uint8_t *strip_pixels(const struct strip_layout *layout, size_t index, const uint8_t *rgba);

/* The bytes to allocate for a file's head of `bytes` bytes: `bytes` rounded up to 4 KiB. The length
 * of a head changes with the number of digits in the metadata. Rounded, the heads of a turning
 * camera all fit the same block of the block cache (server/base/block_cache.h). */
size_t strip_head_bound(size_t bytes);

#endif
