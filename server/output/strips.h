/* How a picture is cut into horizontal strips, so that threads can share the work of encoding it:
 * what the encoders of files have in common. Pure, any thread. */
#ifndef SHEEN_OUTPUT_STRIPS_H
#define SHEEN_OUTPUT_STRIPS_H

#include <stddef.h>
#include <stdint.h>

/* Strip i begins at row i * rows; the last strip has the rows that are left. */
struct strip_layout {
    uint32_t width_px, height_px;
    uint32_t rows; /* of each strip but the last */
    size_t n;      /* strips */
    size_t bound;  /* what to allocate for an encoded strip */
};

/* Cuts a picture into strips of about PROTOCOL_STRIP_BYTES of R, G, B and A of 8 bits each, whose
 * rows are a multiple of `multiple` (but for the last strip's). Sides are from 1 to
 * PROTOCOL_MAX_SIZE_PX. Leaves layout->bound 0: the encoder sets it. */
void strip_layout_init(struct strip_layout *layout, uint32_t width_px, uint32_t height_px,
                       uint32_t multiple);

/* Rows of a strip. */
uint32_t strip_rows(const struct strip_layout *layout, size_t index);
/* The first pixel of a strip in a picture whose rows are contiguous. */
const uint8_t *strip_pixels(const struct strip_layout *layout, size_t index, const uint8_t *rgba);

/* What to allocate for a file's head of so many bytes: that, rounded up to 4 KiB. Heads hold the
 * metadata, whose length changes with the digits of the camera's numbers; rounded, a camera that
 * turns takes the same spare block (server/base/block_cache.h) again and again. */
size_t strip_head_bound(size_t bytes);

#endif
