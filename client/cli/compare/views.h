/* The views of the pictures of `sheen compare`: a file with a camera on each line, written as on
 * the command line.
 * Thread: one. */
#ifndef SHEEN_CLIENT_VIEWS_H
#define SHEEN_CLIENT_VIEWS_H

#include <stddef.h>

#include "client/lib/sheen.h"

enum { MOST_VIEWS = 64, VIEW_BYTES = 500 };

struct views {
    size_t n; /* 0: none are given */
    struct {
        char text[VIEW_BYTES]; /* the line */
        struct sheen_camera camera;
    } list[MOST_VIEWS];
};

/* Reads the file; NULL: no views. SHEEN_BAD_ARGUMENT, with the line, if it cannot be read, has no
 * view, or a line has other options than those of a camera. */
enum sheen_status views_read(const char *path, struct views *views, struct sheen_error *error);

#endif
