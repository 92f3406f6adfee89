#include "server/output/jpeg.h"

#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

/* The pixels that one coded unit (MCU) covers: 8x8 samples of each channel, whose colour samples
 * cover more pixels the more they are subsampled. */
static const struct {
    uint32_t width_px, height_px;
    int library; /* libjpeg-turbo's number */
} UNITS[] = {
    [JPEG_444] = {8, 8, TJSAMP_444},
    [JPEG_422] = {16, 8, TJSAMP_422},
    [JPEG_420] = {16, 16, TJSAMP_420},
};

/* A segment: 0xff, its kind, then the length of what follows, which counts its own two bytes. */
enum { SOF0 = 0xc0, RST0 = 0xd0, SOS = 0xda, DRI = 0xdd, COM = 0xfe };
#define SEGMENT_HEAD_BYTES 4
#define SEGMENT_BYTES (UINT16_MAX - (size_t)2) /* at most */
#define DRI_BYTES (SEGMENT_HEAD_BYTES + 2)
#define SOI_BYTES 2
/* SOI and APP0 with the 14 bytes of JFIF, which must come first in a file. */
#define JFIF_BYTES (SOI_BYTES + SEGMENT_HEAD_BYTES + 14)

void jpeg_keep_defaults(void)
{
    unsetenv("TJ_ARITHMETIC");
    unsetenv("TJ_OPTIMIZE");
    unsetenv("TJ_PROGRESSIVE");
    unsetenv("TJ_RESTART");
}

struct jpeg_encoder *jpeg_encoder_create(void)
{
    return tjInitCompress();
}

void jpeg_encoder_destroy(struct jpeg_encoder *encoder)
{
    if (encoder)
        tjDestroy(encoder);
}

void jpeg_layout_init(struct jpeg_layout *layout, uint32_t width_px, uint32_t height_px,
                      const struct jpeg_options *options)
{
    struct strip_layout *strips = &layout->strips;
    layout->options = *options;
    strip_layout_init(strips, width_px, height_px, UNITS[options->subsampling].height_px);
    strips->bound =
        tjBufSize((int)width_px, (int)strip_rows(strips, 0), UNITS[options->subsampling].library);
}

/* --- strips */

static void put_u16(uint8_t *bytes, size_t value)
{
    bytes[0] = (uint8_t)(value >> 8);
    bytes[1] = (uint8_t)value;
}

/* The offset of the first segment of a kind in a file of the library, which has such a segment. */
static size_t find_segment(const uint8_t *file, uint8_t kind)
{
    size_t at = SOI_BYTES;
    while (file[at + 1] != kind)
        at += 2 + ((size_t)file[at + 2] << 8 | file[at + 3]);
    return at;
}

bool jpeg_strip_encode(struct jpeg_encoder *encoder, const struct jpeg_layout *layout, size_t index,
                       const uint8_t *rgba, uint8_t *bytes, size_t *start, size_t *size,
                       struct error *error)
{
    const struct strip_layout *strips = &layout->strips;
    unsigned long length = 0;
    /* The transform that is less accurate saves no time here. */
    if (tjCompress2(encoder, strip_pixels(strips, index, rgba), (int)strips->width_px, 0,
                    (int)strip_rows(strips, index), TJPF_RGBX, &bytes, &length,
                    UNITS[layout->options.subsampling].library, (int)layout->options.quality,
                    TJFLAG_NOREALLOC | TJFLAG_ACCURATEDCT) != 0)
        return error_set(error, ERROR_SERVER,
                         "a JPEG file of %u x %u pixels cannot be written: %s: try again later",
                         strips->width_px, strips->height_px, tjGetErrorStr2(encoder));
    const size_t scan = find_segment(bytes, SOS);
    *start = scan + 2 + ((size_t)bytes[scan + 2] << 8 | bytes[scan + 3]);
    *size = length;
    if (index + 1 < strips->n) /* it ends with the picture's end marker */
        bytes[length - 1] = (uint8_t)(RST0 + index % 8);
    return true;
}

/* --- the head */

static size_t text_bytes(const struct image_attribute *attributes, size_t n)
{
    size_t bytes = 0;
    for (size_t i = 0; i < n; i++)
        bytes += strlen(attributes[i].name) + strlen(attributes[i].value) + strlen("=\n");
    return bytes;
}

/* The comment, in as many segments as it needs. */
struct comment {
    uint8_t *at;
    size_t left, left_in_segment; /* of the text */
};

static void begin_segment(struct comment *comment)
{
    size_t size = comment->left < SEGMENT_BYTES ? comment->left : SEGMENT_BYTES;
    comment->at[0] = 0xff;
    comment->at[1] = COM;
    put_u16(comment->at + 2, size + 2);
    comment->at += SEGMENT_HEAD_BYTES;
    comment->left_in_segment = size;
}

static void add_text(struct comment *comment, const char *text)
{
    for (size_t left = strlen(text); left > 0;) {
        if (comment->left_in_segment == 0)
            begin_segment(comment);
        size_t n = left < comment->left_in_segment ? left : comment->left_in_segment;
        memcpy(comment->at, text, n);
        comment->at += n;
        comment->left -= n;
        comment->left_in_segment -= n;
        text += n;
        left -= n;
    }
}

/* Returns its end. */
static uint8_t *write_comment(uint8_t *bytes, const struct image_attribute *attributes, size_t n)
{
    struct comment comment = {bytes, text_bytes(attributes, n), 0};
    for (size_t i = 0; i < n; i++) {
        add_text(&comment, attributes[i].name);
        add_text(&comment, "=");
        add_text(&comment, attributes[i].value);
        add_text(&comment, "\n");
    }
    return comment.at;
}

size_t jpeg_head_bound(size_t start, const struct image_attribute *attributes, size_t n_attributes)
{
    const size_t text = text_bytes(attributes, n_attributes);
    const size_t segments = (text + SEGMENT_BYTES - 1) / SEGMENT_BYTES;
    return strip_head_bound(start + DRI_BYTES + text + segments * SEGMENT_HEAD_BYTES);
}

size_t jpeg_head_write(const struct jpeg_layout *layout, const uint8_t *strip, size_t start,
                       const struct image_attribute *attributes, size_t n_attributes,
                       uint8_t *bytes)
{
    memcpy(bytes, strip, JFIF_BYTES);
    uint8_t *at = write_comment(bytes + JFIF_BYTES, attributes, n_attributes);
    at[0] = 0xff;
    at[1] = DRI;
    put_u16(at + 2, DRI_BYTES - 2);
    const enum jpeg_subsampling subsampling = layout->options.subsampling;
    const uint32_t unit_px = UNITS[subsampling].width_px;
    const uint32_t units_wide = (layout->strips.width_px + unit_px - 1) / unit_px;
    const uint32_t units_high = layout->strips.rows / UNITS[subsampling].height_px;
    put_u16(at + SEGMENT_HEAD_BYTES, (size_t)units_wide * units_high);
    at += DRI_BYTES;
    memcpy(at, strip + JFIF_BYTES, start - JFIF_BYTES);
    const size_t frame = find_segment(strip, SOF0);
    put_u16(at + frame - JFIF_BYTES + SEGMENT_HEAD_BYTES + 1, layout->strips.height_px);
    return (size_t)(at - bytes) + start - JFIF_BYTES;
}
