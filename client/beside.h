/* Files that a model's file names by relative URI, which lie in its folder or below. Thread: any.
 */
#ifndef SHEEN_CLIENT_BESIDE_H
#define SHEEN_CLIENT_BESIDE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/sheen.h"

/* A data: URI, which holds its bytes itself. */
bool beside_is_data(const char *uri);

/* Reads the file that `uri` names beside the file `path`: percent-encoding decoded, every link
 * followed. Refused with SHEEN_BAD_MODEL are other URIs than relative ones, ".." and what lies
 * outside of the folder once links are followed; with SHEEN_TOO_BIG a file of more than `most`
 * bytes; else it is file_read(). *bytes is the caller's to free(). Error texts name the file, or
 * the URI, not `path`. */
enum sheen_status beside_read(const char *path, const char *uri, uint64_t most, uint8_t **bytes,
                              size_t *n_bytes, struct sheen_error *error);

#endif
