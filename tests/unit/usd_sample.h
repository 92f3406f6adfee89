/* USD texts for tests of its reader. */
#ifndef SHEEN_TESTS_USD_SAMPLE_H
#define SHEEN_TESTS_USD_SAMPLE_H

#include <stdlib.h>

#include "tests/unit/cage_expect.h"

#define USD "#usda 1.0\n" /* line 1 */
/* Two quads side by side in three lines, vertices 0 1 2 / 3 4 5. */
#define USD_PAIR                                                                                   \
    "point3f[] points = [(0,0,0),(1,0,0),(2,0,0),(0,1,0),(1,1,0),(2,1,0)]\n"                       \
    "int[] faceVertexCounts = [4, 4]\n"                                                            \
    "int[] faceVertexIndices = [0,1,4,3, 1,2,5,4]\n"
/* A mesh with these lines; its first line is "def Mesh". */
#define USD_MESH(lines) "def Mesh \"m\" {\n" lines "}\n"

/* As read_bytes(), for a USD text named part.usda. */
static inline void read_usd(struct cage *cage, const char *text)
{
    read_bytes(cage, text, strlen(text), "part.usda");
}

/* A USD text that must be refused with this message. */
static inline void expect_bad_usd(const char *text, size_t size, const char *message)
{
    expect_cage_refused(text, size, "part.usda", message);
}

#endif
