/* False colour: paints a frame's colour plane from its other planes, and draws a legend over it.
 *
 * kind                        colours
 * curvature, gaussian, mean   blue below 0, light grey at 0, red above 0; they end at -range and range
 * normal                      0.5 + 0.5 N as red, green, blue
 * ptex                        a hue for each face; brightness grows with u, saturation with v
 * draft                       90 degrees - angle(N, direction): green from range up, red from -range
 *                             down, darker with the angle; yellow from 0 to range, amber from -range
 *                             to 0
 *
 * A pixel shows the value at its centre, as the planes do. Where the frame has the coverage plane,
 * pixels that the surface covers only partly (at outlines) are blended with `empty`.
 * Any thread. */
#ifndef SHEEN_OUTPUT_FALSE_COLOUR_H
#define SHEEN_OUTPUT_FALSE_COLOUR_H

#include "protocol/messages/message.h"
#include "server/scene/frame.h"

/* The least and the greatest value among the pixels whose centre has a value. */
struct false_colour_extremes {
    bool has_values; /* false: no pixel has a value, or the kind has no scale */
    /* Each has a place (pixel and position; also face, u and v if the frame has the Ptex plane),
     * unless the two values differ by no more than rounding can explain: 1e-5 rad for DRAFT, else
     * the curvature of a surface whose normal turns by 1e-5 rad over `size`. */
    sheen_Extreme least, greatest;
};

/* True if the request wants a legend, which is the default. */
bool false_colour_has_legend(const sheen_Show *show);

/* Paints frame->plane[0], 8-bit sRGB. The frame has the planes that message_render_planes() names
 * for this request. `miss` is the colour where the surface has no such value, `empty` where a pixel
 * shows no surface; both are RGBA in [0, 1]. `size` is the diagonal of the model's box in world
 * units, at least 0. Cannot fail.
 *
 * If the kind has a scale and the request gives no range, this function chooses one and stores it
 * in show->range: 3 degrees for DRAFT. For curvature it is the magnitude that 98 % of the values do
 * not exceed, rounded up to two digits, but at least the curvature of a surface whose normal turns
 * by 1e-5 rad over `size`: otherwise the picture of a flat model would show rounding errors in full
 * colours. */
void false_colour_paint(const struct frame *frame, sheen_Show *show, double size,
                        const float miss[4], const float empty[4],
                        struct false_colour_extremes *extremes);

#endif
