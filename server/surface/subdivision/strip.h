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

/* More steps than this would cost single precision its last digits across the crease: such quads
 * are cut in four first. */
enum { STRIP_MAX_LEVELS = 3 };

/* How many steps L the quad's crease takes when it is such a quad, with the crease on edge
 * *edge; 0 when it is none. */
unsigned strip_levels(const struct quad *quad, unsigned *edge);

/* Writes (levels + 1) * LIMIT_PATCH_TEXELS texels and as many bounds as patches, for a quad turned
 * so that the crease is its edge 0, and the origin (world). */
void strip_table(const struct quad *quad, unsigned levels, float (*texels)[4],
                 struct limit_bound *bounds, double origin[3]);

#endif
