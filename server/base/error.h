/* A failure: a text for people and a kind for programs.
 *
 * Every function of the daemon that can fail takes a `struct error *` last and returns false or
 * NULL on failure. It fills in the struct exactly once, where the failure is found. The caller owns
 * the struct.
 * Thread: one at a time for each struct; the functions keep no state. */
#ifndef SHEEN_BASE_ERROR_H
#define SHEEN_BASE_ERROR_H

#include <stdbool.h>

enum error_kind {
    ERROR_NONE,
    ERROR_REQUEST,  /* the request is malformed or out of range; exit code of the client: 2 */
    ERROR_MODEL,    /* the cage is bad or not supported; 3 */
    ERROR_IMAGE,    /* an image is bad or cannot be written; 3 */
    ERROR_SERVER,   /* the daemon cannot do it now (no memory, shutting down); 4 */
    ERROR_DEVICE,   /* EGL, OpenGL or the GPU failed; 5 */
    ERROR_GPU_LOST, /* the GPU was lost during a frame, which may be requested again; 4 */
};

struct error {
    enum error_kind kind;
    char text[480]; /* one line of UTF-8: what failed, where, and what to do */
};

/* Fills *error (which may be NULL) and returns false, so that a failing function can end with
 * `return error_set(error, ...)`. Control characters in the result become '?'. */
bool error_set(struct error *error, enum error_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
