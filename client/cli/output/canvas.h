/* A picture that the client composes itself: panels and captions on white, written as PNG.
 *
 * Memory is the canvas's own. Coordinates are pixels from the top left; what lies outside is cut
 * away. Thread: one canvas belongs to one thread. */
#ifndef SHEEN_CLIENT_CANVAS_H
#define SHEEN_CLIENT_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"

struct canvas {
    uint32_t width_px, height_px;
    uint8_t *rgb;
};

/* White. False when there is no memory. */
bool canvas_init(struct canvas *canvas, uint32_t width_px, uint32_t height_px);
void canvas_finish(struct canvas *canvas); /* a zeroed one is safe */

/* Lays RGBA pixels with straight alpha over what is there. */
void canvas_picture(struct canvas *canvas, uint32_t x, uint32_t y, const uint8_t (*rgba)[4],
                    uint32_t width_px, uint32_t height_px);

/* One line of black text in the letters of glyphs.h, each of their pixels `scale` wide; nothing is
 * drawn from column x_end on. */
void canvas_text(struct canvas *canvas, uint32_t x, uint32_t y, uint32_t x_end, uint32_t scale,
                 const char *text);

/* Writes the file whole or not at all, as file_write() does. */
enum sheen_status canvas_write_png(const struct canvas *canvas, const char *path,
                                   struct sheen_error *error);

#endif
