/* The names of numbered frames' files: a path with one %d in its last part, as FRAME_%04d.png.
 *
 * Points into the path it was made of. Pure, any thread. */
#ifndef SHEEN_CLIENT_FRAME_NAMES_H
#define SHEEN_CLIENT_FRAME_NAMES_H

#include <stdbool.h>
#include <stdint.h>

struct frame_names {
    const char *path; /* what comes before the number: the first n_before bytes of it */
    int n_before;
    int width;         /* of the number at least, 0 to 9 */
    bool has_zeros;    /* in front; else blanks */
    const char *after; /* what comes behind it */
};

/* False when the path has not exactly one %d, or with a width of 1 to 9 one %Nd or %0Nd, or has
 * another % or the %d in a folder's name. */
bool frame_names_parse(const char *path, struct frame_names *names);

/* The caller's to free(); NULL: no memory. Different numbers have different names. */
char *frame_names_path(const struct frame_names *names, uint32_t number);

#endif
