/* sheen_read_file() of sheen.h. */
#include <stdlib.h>

#include "client/lib/files/gltf_pack.h"
#include "client/lib/files/read_file.h"
#include "client/lib/status.h"

enum sheen_status sheen_read_file(enum sheen_file_kind kind, const char *path, uint8_t **bytes,
                                  size_t *n_bytes, struct sheen_error *error)
{
    bool is_model = kind == SHEEN_FILE_MODEL;
    if (!path || !bytes || !n_bytes || (!is_model && kind != SHEEN_FILE_IMAGE))
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "sheen_read_file: kind must be a model or an image, and path, bytes and "
                          "n_bytes not NULL");
    *bytes = NULL;
    *n_bytes = 0;
    const enum sheen_status bad = is_model ? SHEEN_BAD_MODEL : SHEEN_BAD_IMAGE;
    if (!*path)
        return status_set(error, bad, "the %s's name is empty", is_model ? "model" : "image");
    uint8_t *read = NULL;
    size_t n_read = 0;
    enum sheen_status status = read_file(path, bad, &read, &n_read, error);
    if (!status && is_model)
        status = gltf_pack(path, &read, &n_read, error);
    if (status) {
        free(read);
        return status;
    }
    *bytes = read;
    *n_bytes = n_read;
    return SHEEN_OK;
}
