/* Reads whole files for uploads. Any thread. */
#ifndef SHEEN_CLIENT_READ_FILE_H
#define SHEEN_CLIENT_READ_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* Reads a file of 1 byte up to the protocol's largest upload. The caller frees *bytes. A file that
 * cannot be used returns `status`: SHEEN_BAD_MODEL or SHEEN_BAD_IMAGE; further SHEEN_TOO_BIG and
 * SHEEN_NO_MEMORY. On failure *bytes is unchanged. Error texts begin with `path`. */
enum sheen_status read_file(const char *path, enum sheen_status status, uint8_t **bytes,
                            size_t *n_bytes, struct sheen_error *error);

/* As read_file(), but no part of `path` may be a symbolic link. So a path from realpath() that was
 * checked is the file that is opened, even if links are placed meanwhile. Without openat2() in the
 * kernel only the last part is checked. */
enum sheen_status read_file_linkless(const char *path, enum sheen_status status, uint8_t **bytes,
                                     size_t *n_bytes, struct sheen_error *error);

#endif
