/* A progress bar on standard error: only on a terminal, at most ten times a second, in colour only
 * without NO_COLOR; and notes between, anywhere but with --quiet. Thread: one. */
#ifndef SHEEN_CLIENT_PROGRESS_H
#define SHEEN_CLIENT_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"

struct progress {
    bool is_shown; /* a terminal, and not --quiet */
    bool is_quiet;
    bool has_colour;
    bool is_drawn; /* a bar stands on the line */
    int64_t last_ms;
};

/* Fills *progress and returns what libsheen calls; *progress must outlive those calls. */
struct sheen_progress progress_init(struct progress *progress, bool quiet);

/* One line on standard error, "sheen: ...", wherever that is; none with --quiet. */
void progress_note(struct progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Wipes the bar, before anything else is written to standard error. Safe to repeat. */
void progress_clear(struct progress *progress);

#endif
