/* cage_check() for a cage whose lines in the file are known. Internal to server/cage. */
#ifndef SHEEN_CAGE_CHECK_H
#define SHEEN_CAGE_CHECK_H

#include "server/cage/cage.h"

/* The line (from 1) of each part, for messages; NULL arrays where the file has no lines. */
struct cage_lines {
    const uint32_t *face;   /* [n_faces] */
    const uint32_t *crease; /* [n_creases] */
    const uint32_t *corner; /* [n_corners] */
    const uint32_t *hole;   /* [n_holes] */
};

/* As cage_check(); texts say `name`:line where the line is known and not 0. ERROR_SERVER when
 * there is no memory to check with. */
bool cage_check_lines(const struct cage *cage, const struct cage_lines *lines, const char *name,
                      struct error *error);

#endif
