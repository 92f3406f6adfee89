/* One failure, in words for a person and a kind for a program.
 *
 * Every fallible function of the daemon takes a `struct error *` last, returns false (or NULL) on
 * failure and fills it in exactly once, where the failure is found. The caller owns the struct.
 * Thread: a `struct error` belongs to one thread at a time; the functions keep no state. */
#ifndef SHEEN_BASE_ERROR_H
#define SHEEN_BASE_ERROR_H

#include <stdbool.h>

enum error_kind {
    ERROR_NONE,
    ERROR_REQUEST, /* the request is malformed or out of range: client exit code 2 */
    ERROR_MODEL,   /* the cage is bad or not supported: client exit code 3 */
    ERROR_IMAGE,   /* an image is bad or cannot be written: client exit code 3 */
    ERROR_SERVER,  /* the service cannot do it now (no memory, shutting down): client exit code 4 */
    ERROR_DEVICE,  /* EGL, OpenGL or the GPU failed: client exit code 5 */
    ERROR_GPU_LOST, /* the GPU went away under a frame; it may be asked for again: exit code 4 */
};

struct error {
    enum error_kind kind;
    char text[480]; /* one line, UTF-8, no newline: what, where, what to do */
};

/* Fills *error (which may be NULL) and returns false, so that a failing function can end with
 * `return error_set(error, ...)`. Control characters in the result become '?'. */
bool error_set(struct error *error, enum error_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
