/* Lines on a patch at points and along segments: signs of F, and where F changes its sign. Pure, any thread. */
#ifndef SHEEN_FIELDS_CROSSINGS_H
#define SHEEN_FIELDS_CROSSINGS_H

#include "server/curves/fields/field.h"

/* F counts as positive if it is not below -LINE_NOISE times its bound (field_bound()). So where F is 0 along a whole border
 * of patches, as in a model's plane of symmetry, both sides agree on its sign, and the line runs in one of them. The
 * bound is that of products of largest values and so far above F; what F rounds by is below this share of it. */
#define LINE_NOISE 2e-16

/* A field on a patch. The bezier is the caller's. */
struct patch_field {
    const struct line_field *field;
    const struct bezier *bezier;
    struct field_bounds bounds;
};
void patch_field_init(struct patch_field *on, const struct line_field *field,
                      const struct bezier *bezier);

double patch_field_noise(const struct patch_field *on, const struct field_line *line);

/* F and its derivatives by u and v at the patch's parameters `at`; the normal's largest coordinate is 1. `surface`, unless NULL,
 * becomes position and normal. */
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

enum { MOST_CROSSINGS = 64 };
/* Finds where F changes its sign along the segment, ascending, from 0 to 1 along it, if F counts as negative at its ends as
 * `negative` says. The number of crossings, which is returned, is odd if these signs differ. Crossings nearer to each other than 2^-40
 * count as one, or as none if the sign is the same on both sides of them. */
int crossings_find(const struct crossings *crossings, const struct patch_field *on,
                   const struct field_line *line, const bool negative[2],
                   double at[MOST_CROSSINGS]);

/* The only crossing along the segment, where the signs at its ends differ. */
double crossings_only(const struct segment *segment, const struct patch_field *on,
                      const struct field_line *line, bool is_negative_first);

#endif
