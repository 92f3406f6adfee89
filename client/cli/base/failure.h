/* Reports failures of the command itself in libsheen's struct sheen_error. Pure, any thread. */
#ifndef SHEEN_CLIENT_FAILURE_H
#define SHEEN_CLIENT_FAILURE_H

#include "client/lib/sheen.h"

/* Fills *error and returns `status`, so that a failing function can end with
 * `return failure_set(error, ...)`. Control characters in the result become '?'. */
enum sheen_status failure_set(struct sheen_error *error, enum sheen_status status,
                              const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
