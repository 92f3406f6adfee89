/* --weld: marks an OBJ file so that its reader joins vertices at equal positions. Any thread. */
#ifndef SHEEN_CLIENT_WELD_TAG_H
#define SHEEN_CLIENT_WELD_TAG_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* Appends the tag `t weld 0/0/0` to the bytes of an OBJ file. A model is identified by the SHA-256
 * of its file, so the welded and the plain model are different models.
 *
 * *bytes has *n_bytes bytes, from malloc(); the caller frees it in all cases. On success it may
 * have moved, on failure it is unchanged. `path` tells the format (by its ending first, then by the
 * bytes) and is named in errors. SHEEN_BAD_ARGUMENT if the file is glTF or USD; any other file counts
 * as OBJ. SHEEN_NO_MEMORY when memory is short. */
enum sheen_status weld_tag_append(const char *path, uint8_t **bytes, size_t *n_bytes,
                                  struct sheen_error *error);

#endif
