/* Random cages of all kinds: sheets, bodies, fans, pages of a book, cubes that share edges and
 * vertices; with lost faces, triangles and n-gons, sheets glued to edges and vertices; every tag
 * and mode. The same seed makes the same cage. */
#ifndef SHEEN_TESTS_ORACLE_RANDOM_CAGE_H
#define SHEEN_TESTS_ORACLE_RANDOM_CAGE_H

#include <cstdint>
#include <string>

#include "tests/oracle/cage_file.h"

struct random_cage {
    loose_cage parts;
    std::string story; /* a description of how it was made */
};

random_cage make_random_cage(uint64_t seed);

#endif
