#include "client/weld_tag.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "client/status.h"

/* Two line ends: a file may end in a backslash, which continues its line. */
static const char TAG[] = "\n\nt weld 0/0/0\n";
#define TAG_BYTES (sizeof(TAG) - 1)

static bool ends_with(const char *text, const char *ending)
{
    size_t length = strlen(text), n = strlen(ending);
    return length >= n && strcasecmp(text + length - n, ending) == 0;
}

/* As the daemon tells formats: by the name's ending, else by how the file begins. */
static bool is_gltf(const char *path, const uint8_t *bytes, size_t n_bytes)
{
    size_t at = 0;
    if (ends_with(path, ".gltf") || ends_with(path, ".glb"))
        return true;
    if (ends_with(path, ".obj"))
        return false;
    if (n_bytes >= 4 && memcmp(bytes, "glTF", 4) == 0)
        return true;
    while (at < n_bytes && bytes[at] && strchr(" \t\r\n", bytes[at]))
        at++;
    return at < n_bytes && bytes[at] == '{';
}

enum sheen_status weld_tag_append(const char *path, uint8_t **bytes, size_t *n_bytes,
                                  struct sheen_error *error)
{
    if (is_gltf(path, *bytes, *n_bytes))
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "%s: --weld is for OBJ; equal positions inside a mesh of a glTF file are "
                          "joined without it",
                          path);
    uint8_t *longer = realloc(*bytes, *n_bytes + TAG_BYTES);
    if (!longer)
        return status_set(error, SHEEN_NO_MEMORY, "%s: no memory to add to it", path);
    memcpy(longer + *n_bytes, TAG, TAG_BYTES);
    *bytes = longer;
    *n_bytes += TAG_BYTES;
    return SHEEN_OK;
}
