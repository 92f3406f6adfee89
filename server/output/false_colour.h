/* False colour: a frame's colour plane painted from its other planes, with a legend.
 *
 * curvature, gaussian, mean   blue below 0, light grey at 0, red above, ending at -range and range
 * normal                      0.5 + 0.5 N as red, green, blue
 * ptex                        a colour for each face, brighter with u and richer with v
 * draft                       90 degrees - angle(N, direction): green from range up, red from minus
 *                             range down, deeper with the angle; yellow between, amber below 0
 *
 * A pixel shows the value at its centre, as the planes do. Where the frame has the coverage plane,
 * pixels that the surface covers in part, which are at outlines, are blended with `empty`. A worker
 * process draws the legend's texts; where it fails the legend has none, and the log says so once.
 * Any thread. */
#ifndef SHEEN_OUTPUT_FALSE_COLOUR_H
#define SHEEN_OUTPUT_FALSE_COLOUR_H

#include "protocol/message.h"
#include "server/scene/frame.h"
#include "server/threads/workers.h"

/* The least and the greatest value of a scale, of all pixels whose centre has one. */
struct false_colour_extremes {
    bool has_values; /* false: no pixel has a value, or the kind has no scale */
    /* They name a place (pixel, position; face, u and v where the frame has the Ptex plane) unless
     * the two differ by no more than rounding may: of DRAFT 1e-5 rad, else the curvature of a
     * surface whose normal turns by 1e-5 rad over the model's size. */
    sheen_Extreme least, greatest;
};

/* Is the legend wanted? */
bool false_colour_has_legend(const sheen_Show *show);

/* Paints frame->plane[0]; the frame has the planes of message_render_planes(). `empty` is the
 * colour where no surface covers the pixel, `miss` where the surface has no such value; both RGBA,
 * [0, 1]. `size` is the length of the diagonal of the model's box, in world units, from 0.
 *
 * Where the kind has a scale and the request names no range, the range is chosen and written to
 * show->range: of DRAFT 3 degrees, else the magnitude that 98 of 100 values do not exceed, rounded
 * up to two digits, and no less than the curvature of a surface whose normal turns by 1e-5 rad over
 * `size`, so that the rounding of a flat model is not magnified. */
void false_colour_paint(const struct frame *frame, struct workers *workers, sheen_Show *show,
                        double size, const float miss[4], const float empty[4],
                        struct false_colour_extremes *extremes);

#endif
