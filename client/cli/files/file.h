/* Reads and writes local files: whole, or not at all. Any thread. */
#ifndef SHEEN_CLIENT_FILE_H
#define SHEEN_CLIENT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* Reads a file of 1 byte up to the protocol's largest upload. The caller frees *bytes. A file that
 * cannot be used returns `status`: SHEEN_BAD_MODEL or SHEEN_BAD_IMAGE. */
enum sheen_status file_read(const char *path, enum sheen_status status, uint8_t **bytes,
                            size_t *n_bytes, struct sheen_error *error);

/* As file_read(), but no part of `path` may be a symbolic link. So a path from realpath() that was
 * checked is the file that is opened, even if links are placed meanwhile. Without openat2() in the
 * kernel only the last part is checked. */
enum sheen_status file_read_linkless(const char *path, enum sheen_status status, uint8_t **bytes,
                                     size_t *n_bytes, struct sheen_error *error);

/* Reads the first line, without its end. SHEEN_BAD_ARGUMENT if the file cannot be read, or if the
 * line is empty or does not fit. */
enum sheen_status file_read_line(const char *path, char *line, size_t size,
                                 struct sheen_error *error);

/* False, with SHEEN_BAD_IMAGE in *error, if `path` could not be written: its folder is missing or
 * not writable, or `path` is not a plain file. An early check, before the work. */
enum sheen_status file_check_writable(const char *path, struct sheen_error *error);

/* Writes a temporary file in the same folder and renames it, so that `path` is either unchanged or
 * whole. SHEEN_BAD_IMAGE on failure; the temporary file is then removed. If the file system allows,
 * the temporary file has no name until it is whole, so that a killed process leaves none. */
enum sheen_status file_write(const char *path, const uint8_t *bytes, size_t n_bytes,
                             struct sheen_error *error);

#endif
