/* Files that a model's file names by relative URI, which lie in its folder or below. Thread: any.
 */
#ifndef SHEEN_CLIENT_RELATIVE_FILE_H
#define SHEEN_CLIENT_RELATIVE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* A data: URI, which holds its bytes itself. */
bool relative_file_is_data(const char *uri);

/* Reads the file that `uri` names, relative to the folder of the model's file `path`. The URI's
 * percent-encoding is decoded. Links are followed, and the file at their end must lie in that
 * folder or below it. *bytes, *n_bytes long, is the caller's to free().
 *
 * SHEEN_BAD_MODEL for a URI with a scheme, an empty or absolute one, one with "..", and a file
 * outside of the folder; SHEEN_TOO_BIG for a file of more than `most` bytes; SHEEN_NO_MEMORY;
 * otherwise it fails as file_read() does. *bytes is not set on failure. Error texts name the file
 * or the URI, not `path`.
 */
enum sheen_status relative_file_read(const char *path, const char *uri, uint64_t most,
                                     uint8_t **bytes, size_t *n_bytes, struct sheen_error *error);

#endif
