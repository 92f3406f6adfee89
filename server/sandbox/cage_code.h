/* A cage on its way from the worker that read it to the daemon. Any thread. */
#ifndef SHEEN_SANDBOX_CAGE_CODE_H
#define SHEEN_SANDBOX_CAGE_CODE_H

#include "server/cage/cage.h"
#include "server/sandbox/stream.h"

void cage_write(struct sink *sink, const struct cage *cage);

/* Trusts nothing: the counts must fit the bytes, and all that is in the cage passes cage_check().
 * On failure *cage is empty: ERROR_MODEL, or ERROR_SERVER when memory is short; the text says
 * `name`. */
bool cage_take(struct source *source, struct cage *cage, const char *name, struct error *error);

#endif
