/* Makes a whole PNG file of a picture, strip by strip in the calling thread; the caller frees
 * it. */
#ifndef SHEEN_TESTS_UNIT_PNG_FILE_H
#define SHEEN_TESTS_UNIT_PNG_FILE_H

#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/output/png.h"

static uint8_t *png_file(struct png_encoder *encoder, const uint8_t *rgba, uint32_t width_px,
                         uint32_t height_px, const struct image_attribute *attributes,
                         size_t n_attributes, size_t *size)
{
    struct strip_layout layout;
    png_layout_init(&layout, width_px, height_px);
    bool has_alpha = false;
    for (size_t i = 0; i < layout.n; i++)
        has_alpha |= !png_strip_is_opaque(&layout, i, rgba);
    const size_t head = png_head_bound(attributes, n_attributes);
    uint8_t *file = malloc(head);
    assert_non_null(file);
    *size = png_head_write(&layout, has_alpha, attributes, n_attributes, file);
    assert_true(*size <= head);
    uint32_t checksum = 1;
    for (size_t i = 0; i < layout.n; i++) {
        /* Exactly the bounds, so that sanitizers find writes beyond them. */
        uint8_t *row = malloc(png_row_bytes(&layout));
        uint8_t *strip = malloc(layout.bound);
        struct png_strip written;
        struct error error = {0};
        assert_true(row && strip);
        if (!png_strip_encode(encoder, &layout, i, rgba, has_alpha, row, strip, &written, &error))
            fail_msg("%s", error.text);
        checksum = png_checksum(checksum, &layout, i, has_alpha, written.checksum);
        if (i + 1 == layout.n)
            written.size += png_tail_write(checksum, strip + written.size);
        assert_true(written.size <= layout.bound);
        file = realloc(file, *size + written.size);
        assert_non_null(file);
        memcpy(file + *size, strip, written.size);
        *size += written.size;
        free(strip);
        free(row);
    }
    return file;
}

#endif
