/* False colour: a frame's colour plane painted from its other planes, with a legend.
 *
 * curvature, gaussian, mean   blue below 0, light grey at 0, red above, ending at -range and range
 * normal                      0.5 + 0.5 N as red, green, blue
 * ptex                        a colour for each face, brighter with u and richer with v
 * draft                       90 degrees - angle(N, direction): green from range up, red from minus
 *                             range down, deeper with the angle; yellow between, amber below 0
 *
 * One sample a pixel, at its centre, as the planes are; but where the frame has the coverage plane,
 * pixels that the surface covers in part show what is empty behind it: at outlines. A worker draws
 * the legend's texts; without them there is one line of the log, once. Any thread. */
#ifndef SHEEN_SERVICE_SHOW_H
#define SHEEN_SERVICE_SHOW_H

#include "protocol/message.h"
#include "server/gpu/renderer.h"
#include "server/service/workers.h"

/* The least and the greatest value of a scale, at pixels' centres that show surface. */
struct show_extremes {
    bool has_values; /* false: there is none */
    /* Without a place where all values are alike: differ by no more than a turn of 1e-5 over the
     * model makes, or 1e-5 rad of DRAFT. With face, u and v where the frame has the Ptex plane. */
    sheen_Extreme least, greatest;
};

/* Is the legend wanted? */
bool show_has_legend(const sheen_Show *show);

/* Paints frame->plane[0]; the frame has the planes of message_render_planes(). `empty` is for
 * what no surface covers, `miss` for where it has no such value. A scale whose
 * range is left out gets it: the magnitude that 98 of 100 values do not exceed, rounded up to two
 * digits, and no less than a turn of 1e-5 over a model of this size (above 0), so that a flat one's
 * rounding is not magnified; DRAFT: 3 degrees. *extremes is of kinds with a scale; else it has no
 * values. */
void show_paint(const struct frame *frame, struct workers *workers, sheen_Show *show, double size,
                const float miss[4], const float empty[4], struct show_extremes *extremes);

#endif
