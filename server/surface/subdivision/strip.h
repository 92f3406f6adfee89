/* A quad along a semi-sharp crease of constant sharpness: refined across the crease only.
 *
 * Along the crease the surface is the regular B-spline; across it, step n replaces the crease row
 * by w P0 + (1 - w)(P-1 + 6 P0 + P1)/8 with w = min(s_n, 1), s_n = s - n, until sharpness is gone
 * (server/surface/README.md 5; Niessner, Loop and Greiner 2012). Patch n = 1..L covers 2^-n <= v <= 2^(1-n),
 * patch L + 1 what is left, each with 16 points. */
#ifndef SHEEN_SURFACE_SUBDIVISION_STRIP_H
#define SHEEN_SURFACE_SUBDIVISION_STRIP_H

#include "server/surface/subdivision/quad.h"
#include "server/surface/tables.h"

/* More steps than this would cost single precision its last digits across the crease: quads with more
 * are split first. */
enum { STRIP_MAX_LEVELS = 3 };

/* How many steps L the crease of such a quad takes, and which of its edges the crease is. Returns 0 for
 * any other quad. Pure. */
unsigned strip_levels(const struct quad *quad, unsigned *edge);

/* The points of a quad that is turned so that the crease is its edge 0, with levels = L: those of its
 * own net, then those of its L + 1 patches, 4 (j + 1) + i + 1 each, from the origin, which is the mean
 * of its own net, world. Pure. */
void strip_points(const struct quad *quad, unsigned levels, struct vec whole[16],
                  struct vec (*patch)[16], double origin[3]);

#endif
