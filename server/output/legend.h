/* The legend of a false-colour picture: a title over a bar of colours with marks under it, on a
 * dark panel in the lower right corner. Its size follows the picture's height. Any thread. */
#ifndef SHEEN_OUTPUT_LEGEND_H
#define SHEEN_OUTPUT_LEGEND_H

#include <stdbool.h>
#include <stdint.h>

#include "server/threads/workers.h"

/* A picture of less height, or too narrow for the legend, has none. */
#define LEGEND_MIN_HEIGHT_PX 120
#define LEGEND_MAX_MARKS 5

struct legend_mark {
    double at; /* 0 to 1 along the bar */
    char text[24];
};

struct legend {
    const char *title;
    /* The bar's colour at s to the right and t upwards, 0 to 1, as displayed. */
    void (*colour)(const void *context, double s, double t, float rgb[3]);
    const void *context;
    unsigned n_marks;
    struct legend_mark marks[LEGEND_MAX_MARKS];
};

/* Draws over the pixels of a colour plane, its texts' masks in memory of `block_cache` (NULL:
 * malloc's). False, saying why, when a text cannot be drawn; the bar is. */
bool legend_draw(uint8_t *rgba, uint32_t width_px, uint32_t height_px, const struct legend *legend,
                 struct workers *workers, struct block_cache *block_cache, struct error *error);

#endif
