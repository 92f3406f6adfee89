#include "client/cli/files/weld_tag.h"

#include <stdlib.h>
#include <string.h>

#include "client/cli/base/failure.h"
#include "protocol/model_format.h"

/* Begins with two newlines: a file may end in a backslash, which continues its line. */
static const char TAG[] = "\n\nt weld 0/0/0\n";
#define TAG_BYTES (sizeof(TAG) - 1)

static const char PATCHES_JOINED[] =
    "patches are joined where a boundary curve is the same in both";

enum sheen_status weld_tag_append(const char *path, uint8_t **bytes, size_t *n_bytes,
                                  struct sheen_error *error)
{
    static const char *const joined[] = {
        [MODEL_OBJ] = NULL,
        [MODEL_GLTF] = "equal positions inside a mesh of a glTF file are joined without it",
        [MODEL_USD] = "a mesh of a USD file names by index which vertices its faces share",
        [MODEL_BPT] = PATCHES_JOINED,
        [MODEL_PATCHES] = PATCHES_JOINED,
    };
    const char *reason = joined[model_format(path, *bytes, *n_bytes)];
    if (reason)
        return failure_set(error, SHEEN_BAD_ARGUMENT, "%s: --weld is for OBJ; %s", path, reason);
    uint8_t *longer = realloc(*bytes, *n_bytes + TAG_BYTES);
    if (!longer)
        return failure_set(error, SHEEN_NO_MEMORY, "%s: no memory to add to it", path);
    memcpy(longer + *n_bytes, TAG, TAG_BYTES);
    *bytes = longer;
    *n_bytes += TAG_BYTES;
    return SHEEN_OK;
}
