/* --weld: an OBJ file with the request to join its equal positions. Thread: any. */
#ifndef SHEEN_CLIENT_WELD_H
#define SHEEN_CLIENT_WELD_H

#include <stddef.h>
#include <stdint.h>

#include "client/sheen.h"

/* Appends the tag that asks for it to the bytes of a file, which are malloc'd: so the request is
 * part of what the model is and is named by, and no daemon, cache or owner mixes the two. `path` is
 * for the format and for messages. SHEEN_BAD_ARGUMENT when it is not OBJ, SHEEN_NO_MEMORY; *bytes
 * is the caller's in all cases. */
enum sheen_status weld_append(const char *path, uint8_t **bytes, size_t *n_bytes,
                              struct sheen_error *error);

#endif
