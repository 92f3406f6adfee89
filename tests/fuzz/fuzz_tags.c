/* OpenSubdiv's tags after a good cage of 3 x 3 faces, and the tables of the surface that they
 * shape. */
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/cage.h"
#include "tests/fuzz/fuzz.h"

static const char GRID[] =
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 1\nv 2 1 1\nv 3 1 0\n"
    "v 0 2 0\nv 1 2 1\nv 2 2 1\nv 3 2 0\nv 0 3 0\nv 1 3 0\nv 2 3 0\nv 3 3 0\n"
    "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 5 6 10 9\nf 6 7 11 10\nf 7 8 12 11\n"
    "f 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\n";

void fuzz_one(const uint8_t *bytes, size_t size)
{
    const size_t start = sizeof GRID - 1;
    char *file = malloc(start + size);
    if (!file)
        return;
    memcpy(file, GRID, start);
    memcpy(file + start, bytes, size);
    fuzz_cage(file, start + size, "fuzz.obj");
    free(file);
}
