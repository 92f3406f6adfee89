/* glTF and GLB files. The content determines which of both a file is. */
#include "tests/fuzz/cage.h"
#include "tests/fuzz/fuzz.h"

void fuzz_one(const uint8_t *bytes, size_t size)
{
    fuzz_cage(bytes, size, "fuzz.gltf");
}
