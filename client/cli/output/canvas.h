/* A picture that the client composes: panels and captions on white, written as PNG.
 *
 * The canvas owns its memory. Coordinates are pixels from the top left; parts outside are cut off.
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_CANVAS_H
#define SHEEN_CLIENT_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"

struct canvas {
    uint32_t width_px, height_px;
    uint8_t *rgb;
};

/* Makes a white canvas. False when memory is short. */
bool canvas_init(struct canvas *canvas, uint32_t width_px, uint32_t height_px);
void canvas_finish(struct canvas *canvas); /* a zeroed canvas is safe */

/* Draws RGBA pixels with straight alpha (sRGB) over the canvas. */
void canvas_picture(struct canvas *canvas, uint32_t x, uint32_t y, const uint8_t (*rgba)[4],
                    uint32_t width_px, uint32_t height_px);

/* Paints a share, 0 to 1, of one pixel with a colour (sRGB); mixed in linear light. */
void canvas_paint(struct canvas *canvas, uint32_t x, uint32_t y, const uint8_t rgb[3],
                  double share);

/* Draws one line of black text in the font of glyphs.h, each of its pixels `scale` wide. Nothing is
 * drawn at column x_end and beyond. */
void canvas_text(struct canvas *canvas, uint32_t x, uint32_t y, uint32_t x_end, uint32_t scale,
                 const char *text);

/* The bytes of a PNG file, malloc'd. SHEEN_NO_MEMORY or SHEEN_BAD_IMAGE; *file is then NULL. */
enum sheen_status canvas_png(const struct canvas *canvas, uint8_t **file, size_t *n_bytes,
                             struct sheen_error *error);
/* Writes the file whole or not at all, by file_write(). */
enum sheen_status canvas_write_png(const struct canvas *canvas, const char *path,
                                   struct sheen_error *error);

#endif
