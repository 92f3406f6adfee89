/* Files: how they are read and named, and how they come to the daemon. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_FILES_H
#define SHEEN_PUBLIC_FILES_H

#include "base.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

enum sheen_file_kind { SHEEN_FILE_MODEL, SHEEN_FILE_IMAGE };

/* Computes the id of a file: the SHA-256 of its bytes. False only if libcrypto fails. */
bool sheen_file_id(const void *bytes, size_t n_bytes, uint8_t id[SHEEN_ID_BYTES]);

/* Reads a file of 1 byte to 1 GiB for sheen_upload(). A glTF model as JSON (.gltf) may name files
 * that hold its buffers: those are read as well, and *bytes is a GLB file that contains model and
 * buffers. Only files in the model's folder or below are read, also where a name is a symbolic
 * link, and no URL is fetched. Images that a model names are not read, because a cage has none.
 *
 * On success *bytes has *n_bytes bytes from malloc(), which the program frees by free(); on failure
 * *bytes is NULL. SHEEN_BAD_MODEL or SHEEN_BAD_IMAGE, by `kind`, if a file cannot or must not be
 * read; SHEEN_TOO_BIG if it is larger, together with its buffers; SHEEN_NO_MEMORY. Needs no
 * session, any thread. */
enum sheen_status sheen_read_file(enum sheen_file_kind kind, const char *path, uint8_t **bytes,
                                  size_t *n_bytes, struct sheen_error *error);

/* Uploads a file, unless the daemon has it; a broken upload continues where it stopped. `id` is
 * sheen_file_id() of the bytes; the daemon verifies it. `name` is the file's name, whose ending
 * tells a model's format; folders in it are dropped, and of a longer name the last 255 bytes are
 * kept. In an OBJ file the line "t weld 0/0/0" joins vertices at equal positions. progress may be
 * NULL. SHEEN_BAD_ARGUMENT while requests are in flight; SHEEN_TOO_BIG, SHEEN_BAD_MODEL or
 * SHEEN_BAD_IMAGE if the daemon refuses the file. */
enum sheen_status sheen_upload(struct sheen_session *session, enum sheen_file_kind kind,
                               const uint8_t id[SHEEN_ID_BYTES], const void *bytes, size_t n_bytes,
                               const char *name, const struct sheen_progress *progress,
                               struct sheen_error *error);

/* Gets the id of a model file in the daemon's own folder (--models); `name` is its path there.
 * Builds the model's tables if needed. SHEEN_BAD_MODEL if there is no such file or it is bad,
 * SHEEN_BAD_REQUEST if the daemon has no such folder, SHEEN_BAD_ARGUMENT while requests are in
 * flight, or if `name` has more than 255 bytes. `id` is unchanged on failure. */
enum sheen_status sheen_find_model(struct sheen_session *session, const char *name,
                                   const struct sheen_progress *progress,
                                   uint8_t id[SHEEN_ID_BYTES], struct sheen_error *error);

SHEEN_DECLARATIONS_END

#endif
