/* The legend of a false-colour picture: a title, a bar of colours and marks below the bar, on a
 * dark panel in the lower right corner. Its size is proportional to the picture's height. Any
 * thread. */
#ifndef SHEEN_OUTPUT_LEGEND_H
#define SHEEN_OUTPUT_LEGEND_H

#include <stdint.h>

/* A picture that is lower than this, or too narrow for the panel, gets no legend. */
#define LEGEND_MIN_HEIGHT_PX 120
#define LEGEND_MAX_MARKS 5

struct legend_mark {
    double at; /* position on the bar, 0 left, 1 right */
    char text[24];
};

struct legend {
    const char *title;
    /* The bar's colour at s (0 left, 1 right) and t (0 bottom, 1 top); sRGB, 0 to 1. */
    void (*colour)(const void *context, double s, double t, float rgb[3]);
    const void *context;
    unsigned n_marks;
    struct legend_mark marks[LEGEND_MAX_MARKS];
};

/* Draws the legend over a colour plane (8-bit sRGB RGBA, rows contiguous, top first). */
void legend_draw(uint8_t *rgba, uint32_t width_px, uint32_t height_px, const struct legend *legend);

#endif
