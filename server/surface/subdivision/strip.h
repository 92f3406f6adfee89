/* A quad along a semi-sharp crease of constant sharpness, which is refined only across the crease.
 *
 * Along the crease the surface is the regular B-spline. Across it, step n replaces the crease's row
 * by w P0 + (1 - w)(P-1 + 6 P0 + P1)/8 with w = min(s_n, 1), s_n = s - n, until no sharpness is
 * left (server/surface/README.md 5; Niessner, Loop and Greiner 2012). Patch n = 1..L covers 2^-n <=
 * v <= 2^(1-n), patch L + 1 the rest; each has 16 points. */
#ifndef SHEEN_SURFACE_SUBDIVISION_STRIP_H
#define SHEEN_SURFACE_SUBDIVISION_STRIP_H

#include "server/surface/subdivision/quad.h"
#include "server/surface/tables.h"

/* More steps would cost single precision its last digits across the crease: quads with more are
 * split first. */
enum { STRIP_MAX_LEVELS = 3 };

/* The number of steps L of the crease of such a quad; *edge is the crease's edge. Returns 0 for any
 * other quad. Pure. */
unsigned strip_levels(const struct quad *quad, unsigned *edge);

/* The points of a quad whose edge 0 is the crease, with levels = L: those of its own net, then
 * those of its L + 1 patches, 4 (j + 1) + i + 1 each, relative to `origin` (world), the mean of its
 * own net. Pure. */
void strip_points(const struct quad *quad, unsigned levels, struct vec whole[16],
                  struct vec (*patch)[16], double origin[3]);

#endif
