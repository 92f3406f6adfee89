/* Reads files that a model's file names by relative URI. They must lie in the model's folder or
 * below. Any thread. */
#ifndef SHEEN_CLIENT_RELATIVE_FILE_H
#define SHEEN_CLIENT_RELATIVE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* True for a data: URI, which contains its bytes. */
bool relative_file_is_data(const char *uri);

/* Reads the file that `uri` names, relative to the folder of the model's file `path`.
 * Percent-encoding is decoded. Symbolic links are followed, and the file that they lead to must lie
 * in that folder or below. The caller frees *bytes, which has *n_bytes bytes.
 *
 * On failure *bytes is not set. SHEEN_BAD_MODEL for a URI with a scheme, an empty or absolute one,
 * one with "..", and a file outside of the folder; SHEEN_TOO_BIG for a file of more than `most`
 * bytes; SHEEN_NO_MEMORY; else as read_file(). Error texts name the file or the URI, not `path`. */
enum sheen_status relative_file_read(const char *path, const char *uri, uint64_t most,
                                     uint8_t **bytes, size_t *n_bytes, struct sheen_error *error);

#endif
