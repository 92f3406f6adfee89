/* Local files of the commands: read whole, written whole or not at all. Thread: any. */
#ifndef SHEEN_CLIENT_FILE_H
#define SHEEN_CLIENT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* Reads a file of 1 byte to the protocol's largest upload. *bytes is the caller's to free().
 * `status` is what a bad file is: SHEEN_BAD_MODEL or SHEEN_BAD_IMAGE. */
enum sheen_status file_read(const char *path, enum sheen_status status, uint8_t **bytes,
                            size_t *n_bytes, struct sheen_error *error);

/* The same, but no part of `path` may be a link: so a path from realpath() that was checked is the
 * one that is opened, whoever puts links there in between. A kernel without openat2() holds to that
 * for the last part alone. */
enum sheen_status file_read_linkless(const char *path, enum sheen_status status, uint8_t **bytes,
                                     size_t *n_bytes, struct sheen_error *error);

/* Reads the first line, without its end, which must not be empty. SHEEN_BAD_ARGUMENT when there is
 * none or it does not fit. */
enum sheen_status file_read_line(const char *path, char *line, size_t size,
                                 struct sheen_error *error);

/* False when `path` could not be written: its folder is missing or closed, or it is there and no
 * plain file. Fills *error with SHEEN_BAD_IMAGE. A hint that comes before the work. */
enum sheen_status file_check_writable(const char *path, struct sheen_error *error);

/* Writes a temporary file in the same folder and renames it, so that `path` is either what it was
 * or whole. SHEEN_BAD_IMAGE on failure; the temporary file is then removed. It has no name before
 * it is whole, where the file system has such files: a process that is killed leaves none. */
enum sheen_status file_write(const char *path, const uint8_t *bytes, size_t n_bytes,
                             struct sheen_error *error);

#endif
