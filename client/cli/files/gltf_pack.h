/* One file out of a .gltf and the files beside it that hold its geometry. Thread: any.
 *
 * The container is a GLB. Its BIN chunk holds the files of the buffers in their order, each as long
 * as its buffer says and filled up with zeros to a multiple of 4. Its JSON chunk is the file's
 * JSON, members in their order and without blanks, in which buffer 0 is the BIN chunk, followed by
 * those buffers that name no file; buffer views say where their bytes are now. All else is kept as
 * it is: images are not part of a cage and are not packed. Equal files make equal bytes: a model is
 * known by their SHA-256. */
#ifndef SHEEN_CLIENT_GLTF_PACK_H
#define SHEEN_CLIENT_GLTF_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"

/* *bytes[0, *n_bytes) are those of the model file `path`. If they are a glTF in JSON whose buffers
 * name files, *bytes is freed and replaced by the container, the caller's to free(). What has no
 * such buffers, or is no JSON at all, stays as it is: the reader at the server says what is wrong
 * with it. Which files are read, and how links are followed, is said at relative_file_read().
 *
 * SHEEN_BAD_MODEL when a file cannot be read or may not be, when a view lies beyond its buffer or
 * not at a whole number, or when the JSON has an integer of more than 64 bits beside such buffers;
 * SHEEN_TOO_BIG when more than PROTOCOL_MAX_UPLOAD_BYTES were to be read or sent; SHEEN_NO_MEMORY.
 * On failure *bytes is as it was. */
enum sheen_status gltf_pack(const char *path, uint8_t **bytes, size_t *n_bytes,
                            struct sheen_error *error);

#endif
