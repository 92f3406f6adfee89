/* --weld: an OBJ file with the request to join its equal positions. Thread: any. */
#ifndef SHEEN_CLIENT_WELD_TAG_H
#define SHEEN_CLIENT_WELD_TAG_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* Appends the tag `t weld 0/0/0` to the bytes of an OBJ file. A model is known by the SHA-256 of
 * its file, so the welded and the plain model are two models to every daemon, cache and owner.
 *
 * *bytes[0, *n_bytes) is malloc'd and is the caller's to free() in all cases; on success it may
 * have moved, else it is as it was. `path` serves to tell the format (by its ending, before the
 * bytes are looked at) and for error texts. SHEEN_BAD_ARGUMENT when the file is glTF: any other
 * counts as OBJ. SHEEN_NO_MEMORY when memory is short. */
enum sheen_status weld_tag_append(const char *path, uint8_t **bytes, size_t *n_bytes,
                                  struct sheen_error *error);

#endif
