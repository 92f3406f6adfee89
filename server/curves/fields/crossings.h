/* Lines on a patch at points and along segments: signs of F, and where F changes its sign. Pure,
 * any thread. */
#ifndef SHEEN_FIELDS_CROSSINGS_H
#define SHEEN_FIELDS_CROSSINGS_H

#include "server/curves/fields/field.h"

/* F counts as positive if it is not below -LINE_NOISE times its bound (field_bound()). So where F
 * is 0 along a whole border of patches, as in a model's plane of symmetry, both sides agree on its
 * sign, and the line runs in one of them. field_bound() multiplies the largest values of all
 * factors, so it is far above F. The rounding error of F is smaller than LINE_NOISE times
 * field_bound(). */
#define LINE_NOISE 2e-16

/* A field on a patch. The bezier is the caller's. */
struct patch_field {
    const struct line_field *field;
    const struct bezier *bezier;
    struct field_bounds bounds;
};
void patch_field_init(struct patch_field *on, const struct line_field *field,
                      const struct bezier *bezier);

/* LINE_NOISE times the bound of a line's F on the patch. */
double patch_field_noise(const struct patch_field *on, const struct field_line *line);

/* F and its derivatives by u and v at the patch's parameters `at`; the normal's largest coordinate
 * is 1. `surface`, unless NULL, becomes position and normal. */
void patch_field_jet(const struct patch_field *on, const struct field_line *line,
                     const double at[2], struct bezier_jet *surface, double jet[3]);

/* Whether F counts as negative. */
bool patch_field_is_negative(const struct patch_field *on, const struct field_line *line,
                             const double at[2]);

/* The sign of F, with the noise added, if its range shows that it is one, else 0. */
int line_range_sign(const double range[RANGE_SIZE], double noise);

/* A segment of a patch, and the terms of a field over it. */
struct crossings {
    struct segment segment;
    struct field_range terms;
};
void crossings_init(struct crossings *crossings, const struct patch_field *on,
                    const struct segment *segment);

/* The most crossings that crossings_find() can return. F has degree 32 at most along a segment, so
 * it has fewer. If rounding makes F change its sign more often, pairs of neighbouring crossings are
 * left out, so that the signs still alternate. */
enum { MOST_CROSSINGS = 64 };
/* Finds the places, from 0 to 1 along the segment and ascending, where F changes its sign.
 * `negative` says whether F counts as negative at the two ends. Returns the number of crossings,
 * which is odd exactly if the two ends differ. Two crossings that are nearer than 2^-40 to each
 * other are not reported. Three are reported as one. Adds to *n_parts the number of parts of the
 * segment on which ranges could not tell the sign, by which the caller can bound its work. */
int crossings_find(const struct crossings *crossings, const struct patch_field *on,
                   const struct field_line *line, const bool negative[2], double at[MOST_CROSSINGS],
                   size_t *n_parts);

/* The only crossing along the segment. The signs of F at its two ends must differ. */
double crossings_only(const struct segment *segment, const struct patch_field *on,
                      const struct field_line *line, bool is_negative_first);

#endif
