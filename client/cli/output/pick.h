/* The numbers of the surface at a place of a picture, as text, CSV and JSON on standard output.
 *
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_PICK_H
#define SHEEN_CLIENT_PICK_H

#include "client/cli/output/json.h"

/* The numbers at a place; NaN where there are none. */
struct pick {
    double x, y;   /* px; whole numbers are centres of pixels */
    uint32_t face; /* Ptex; UINT32_MAX: no surface is there */
    float uv[2], point[3], normal[3], curvature[2], light[2];
};

/* Prints a line for each kind of number. */
void pick_print_table(const struct pick *pick);
/* Prints a line of names, and a line for each pick; a number that there is not is an empty field. */
void pick_print_csv(const struct pick *picks, size_t n);
/* Writes keys into the open object: x, y, hit, and those of the numbers that there are. */
void pick_json(struct json *json, const struct pick *pick);

#endif
