/* Draws text into pictures. Any thread. */
#ifndef SHEEN_OUTPUT_TEXT_H
#define SHEEN_OUTPUT_TEXT_H

#include <stdint.h>

enum text_align { TEXT_LEFT, TEXT_CENTRE, TEXT_RIGHT };

/* The width in pixels of a line of text in the font (font.h) of size_px. */
double text_width_px(const char *line, int size_px);

/* Draws the line over 8-bit RGBA pixels (straight alpha, contiguous rows, top row first). Its
 * baseline begins, has its middle or ends at (x_px, y_px), by `align`; its colour is sRGB with
 * straight alpha, 0 to 1. Parts outside of the picture are left out. */
void text_draw(const char *line, int size_px, uint8_t *rgba, uint32_t width_px, uint32_t height_px,
               int x_px, int y_px, enum text_align align, const float colour[4]);

#endif
