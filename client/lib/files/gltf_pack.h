/* Packs a .gltf and the files that hold its geometry into one file. Any thread.
 *
 * The result is a GLB. Its BIN chunk holds the buffers' files in their order, each cut to the
 * length that its buffer declares and padded with zeros to a multiple of 4. Its JSON chunk is the
 * file's JSON, without blanks, members in their order; buffer 0 is the BIN chunk, followed by the
 * buffers that name no file, and buffer views are adjusted. Everything else is unchanged: images
 * are not part of a cage and are not packed. Equal files give equal bytes, because a model is
 * identified by its SHA-256. */
#ifndef SHEEN_CLIENT_GLTF_PACK_H
#define SHEEN_CLIENT_GLTF_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* *bytes has the *n_bytes bytes of the model file `path`. If they are glTF as JSON with buffers
 * that name files, *bytes is freed and replaced by the GLB, which the caller frees. Otherwise they
 * are unchanged: the reader at the server reports what is wrong with the file. relative_file_read()
 * says which files are read and how links are followed.
 *
 * On failure *bytes is unchanged. SHEEN_BAD_MODEL if a file cannot or must not be read, if a view
 * lies beyond its buffer or has a position that is not a whole number, or if the JSON has such
 * buffers and an integer of more than 64 bits; SHEEN_TOO_BIG if more than PROTOCOL_MAX_UPLOAD_BYTES
 * would be read or sent; SHEEN_NO_MEMORY. */
enum sheen_status gltf_pack(const char *path, uint8_t **bytes, size_t *n_bytes,
                            struct sheen_error *error);

#endif
