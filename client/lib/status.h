/* Fills in a struct sheen_error. Pure, any thread. */
#ifndef SHEEN_CLIENT_STATUS_H
#define SHEEN_CLIENT_STATUS_H

#include "client/lib/sheen.h"

/* Fills *error (which may be NULL) and returns `status`, so that a failing function can end with
 * `return status_set(error, ...)`. Control characters in the result become '?'. */
enum sheen_status status_set(struct sheen_error *error, enum sheen_status status,
                             const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
