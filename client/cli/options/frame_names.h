/* File names of numbered frames: a path with one %d in its last part, such as FRAME_%04d.png.
 *
 * The struct points into the path that it was made of. Pure, any thread. */
#ifndef SHEEN_CLIENT_FRAME_NAMES_H
#define SHEEN_CLIENT_FRAME_NAMES_H

#include <stdbool.h>
#include <stdint.h>

struct frame_names {
    const char *path; /* the first n_before bytes precede the number */
    int n_before;
    int width;         /* minimum width of the number, 0 to 9 */
    bool has_zeros;    /* fill with zeros; else with blanks */
    const char *after; /* what follows the number */
};

/* Parses a path. False unless it has exactly one %d, or %Nd or %0Nd with N from 1 to 9, in its last
 * part, and no other %. */
bool frame_names_parse(const char *path, struct frame_names *names);

/* The path of frame `number`; the caller frees it. NULL when memory is short. Different numbers
 * have different paths. */
char *frame_names_path(const struct frame_names *names, uint32_t number);

#endif
