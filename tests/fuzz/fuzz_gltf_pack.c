/* A .gltf on the client's side that names files beside it, which are those of tests/fuzz. */
#include <stdlib.h>
#include <string.h>

#include "client/lib/files/gltf_pack.h"
#include "tests/fuzz/fuzz.h"

#define PATH "tests/fuzz/model.gltf"

static uint32_t read_u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void check_container(const uint8_t *bytes, size_t size)
{
    MUST(size >= 28 && memcmp(bytes, "glTF\2\0\0", 8) == 0 && read_u32(bytes + 8) == size);
    uint32_t json = read_u32(bytes + 12);
    MUST(json % 4 == 0 && memcmp(bytes + 16, "JSON", 4) == 0 && json <= size - 28);
    MUST(memcmp(bytes + 20 + json + 4, "BIN", 4) == 0);
    MUST(read_u32(bytes + 20 + json) == size - 28 - json);
}

void fuzz_one(const uint8_t *bytes, size_t size)
{
    uint8_t *packed = malloc(size + 1);
    size_t packed_size = size;
    struct sheen_error error = {0};
    if (!packed)
        return;
    memcpy(packed, bytes, size);
    enum sheen_status status = gltf_pack(PATH, &packed, &packed_size, &error);
    MUST(!status == !error.text[0]);
    MUST(status == SHEEN_OK || status == SHEEN_BAD_MODEL || status == SHEEN_TOO_BIG ||
         status == SHEEN_NO_MEMORY);
    MUST(status != SHEEN_NO_MEMORY || fuzz_memory_failed());
    if (status || (packed_size == size && memcmp(packed, bytes, size) == 0))
        MUST(packed_size == size && memcmp(packed, bytes, size) == 0);
    else
        check_container(packed, packed_size);
    free(packed);
}
