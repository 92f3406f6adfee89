/* A progress bar and notes on standard error. The bar is shown only on a terminal, at most ten
 * times a second, and without colour if NO_COLOR is set. Notes are shown always, except with
 * --quiet.
 * Thread: one. */
#ifndef SHEEN_CLIENT_PROGRESS_H
#define SHEEN_CLIENT_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"

struct progress {
    bool is_shown; /* on a terminal and without --quiet */
    bool is_quiet;
    bool has_colour;
    bool is_drawn; /* the bar is on the current line */
    int64_t last_ms;
};

/* Fills in *progress and returns the callback for libsheen; *progress must outlive its calls. */
struct sheen_progress progress_init(struct progress *progress, bool quiet);

/* Prints one line "sheen: ..." on standard error; nothing with --quiet. */
void progress_note(struct progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Removes the bar. Call it before anything else is written to standard error. Safe to repeat. */
void progress_clear(struct progress *progress);

#endif
