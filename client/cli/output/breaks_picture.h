/* Paints edges that are out of tolerance on a picture of lines.
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_BREAKS_PICTURE_H
#define SHEEN_CLIENT_BREAKS_PICTURE_H

#include "client/cli/output/canvas.h"

/* The planes that a frame must have, decoded, to be painted on. */
#define BREAKS_PICTURE_PLANES (SHEEN_PLANE_COLOUR | SHEEN_PLANE_PTEX)

/* Makes a canvas with the frame's picture, and paints on it those parts of edges over a limit that the frame shows: in
 * magenta where the gap is too large, else in red where the angle is, else in orange. *n_hidden is set to the number
 * of edges over a limit of which nothing is painted. False when memory is short. The caller finishes the canvas in any
 * case. */
bool breaks_picture(struct canvas *canvas, const struct sheen_frame *frame,
                    const struct sheen_breaks *breaks, uint32_t *n_hidden);

#endif
