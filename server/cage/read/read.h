/* Reads cages from files. This is the only header of this folder that others include. The folder is
 * linked into the worker program sheend-cage, never into sheend. Any thread. */
#ifndef SHEEN_CAGE_READ_READ_H
#define SHEEN_CAGE_READ_READ_H

#include "server/cage/cage.h"

/* Reads a cage from the bytes of a file. `name` decides the format by its ending, or else the
 * contents do (protocol/model_format.h); it is also used in messages. On success the caller owns
 * *cage, which has passed cage_check(). On failure *cage is empty and needs no cage_finish();
 * ERROR_MODEL for a bad file, ERROR_SERVER when memory is short. */
bool cage_read(struct cage *cage, const void *bytes, size_t size, const char *name,
               struct error *error);

#endif
