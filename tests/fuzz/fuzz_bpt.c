/* Files of Bezier patches. */
#include "tests/fuzz/cage.h"
#include "tests/fuzz/fuzz.h"

void fuzz_one(const uint8_t *bytes, size_t size)
{
    fuzz_cage(bytes, size, "fuzz.bpt");
}
