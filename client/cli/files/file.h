/* The command's own files: reads a line, writes a whole file or none. Any thread. Files for uploads
 * are read by sheen_read_file(). */
#ifndef SHEEN_CLIENT_FILE_H
#define SHEEN_CLIENT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* Reads the first line, without its end. SHEEN_BAD_ARGUMENT if the file cannot be read, or if the
 * line is empty or does not fit. */
enum sheen_status file_read_line(const char *path, char *line, size_t size,
                                 struct sheen_error *error);

/* Checks early, before the work, whether `path` can be written. SHEEN_BAD_IMAGE if its folder is
 * missing, no folder or not writable, if `path` exists and is not a regular file, or when memory is
 * short. */
enum sheen_status file_check_writable(const char *path, struct sheen_error *error);

/* Writes a temporary file in the same folder and renames it, so that `path` is either unchanged or
 * whole. Where `path` is a symbolic link, this is done for the file to which the link leads, and the
 * link stays; that file need not exist. SHEEN_BAD_IMAGE on failure; the temporary file is then removed.
 * If the file system allows, the temporary file has no name until it is whole, so that a killed
 * process leaves none. */
enum sheen_status file_write(const char *path, const uint8_t *bytes, size_t n_bytes,
                             struct sheen_error *error);

#endif
