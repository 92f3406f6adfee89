/* Makes a whole JPEG file of a picture, strip by strip in the calling thread; the caller frees
 * it. */
#ifndef SHEEN_TESTS_UNIT_JPEG_FILE_H
#define SHEEN_TESTS_UNIT_JPEG_FILE_H

#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/output/jpeg.h"

static uint8_t *jpeg_file_of(struct jpeg_encoder *encoder, const struct jpeg_options *options,
                             const uint8_t *rgba, uint32_t width_px, uint32_t height_px,
                             const struct image_attribute *attributes, size_t n_attributes,
                             size_t *size)
{
    struct jpeg_layout layout;
    jpeg_layout_init(&layout, width_px, height_px, options);
    uint8_t *file = NULL;
    *size = 0;
    for (size_t i = 0; i < layout.strips.n; i++) {
        /* Exactly the bound, so that sanitizers find writes beyond it. */
        uint8_t *strip = malloc(layout.strips.bound);
        size_t start, end;
        struct error error = {0};
        assert_non_null(strip);
        if (!jpeg_strip_encode(encoder, &layout, i, rgba, strip, &start, &end, &error))
            fail_msg("%s", error.text);
        size_t head = i == 0 ? jpeg_head_bound(start, attributes, n_attributes) : 0;
        file = realloc(file, *size + head + end - start);
        assert_non_null(file);
        if (i == 0)
            *size = jpeg_head_write(&layout, strip, start, attributes, n_attributes, file);
        assert_true(i > 0 || *size <= head);
        memcpy(file + *size, strip + start, end - start);
        *size += end - start;
        free(strip);
    }
    return file;
}

/* With the daemon's default options. */
static inline uint8_t *jpeg_file(struct jpeg_encoder *encoder, const uint8_t *rgba,
                                 uint32_t width_px, uint32_t height_px,
                                 const struct image_attribute *attributes, size_t n_attributes,
                                 size_t *size)
{
    return jpeg_file_of(encoder, &JPEG_DEFAULTS, rgba, width_px, height_px, attributes,
                        n_attributes, size);
}

#endif
