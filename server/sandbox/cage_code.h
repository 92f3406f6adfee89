/* Serialises a cage: the worker process that read it writes it, and the daemon takes it. Any
 * thread. */
#ifndef SHEEN_SANDBOX_CAGE_CODE_H
#define SHEEN_SANDBOX_CAGE_CODE_H

#include "server/cage/cage.h"
#include "server/sandbox/stream.h"

/* Writes a cage. Failures are kept in sink->ok. */
void cage_write(struct sink *sink, const struct cage *cage);

/* Reads a cage and checks all of it: the counts must fit the bytes, and the cage must pass
 * cage_check(). On success the caller owns the cage. On failure *cage is empty; ERROR_MODEL, or
 * ERROR_SERVER when memory is short. `name` is the file's name for the error. */
bool cage_take(struct source *source, struct cage *cage, const char *name, struct error *error);

#endif
