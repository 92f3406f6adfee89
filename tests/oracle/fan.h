/* Cages around one vertex, made by the test: sectors of 2 x 2 quads in a ring or an arc, with
 * random heights. */
#ifndef SHEEN_TESTS_ORACLE_FAN_H
#define SHEEN_TESTS_ORACLE_FAN_H

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

extern "C" {
#include "server/cage/cage.h"
}

struct fan_shape {
    std::string name;
    int sectors;
    bool closed;
    std::vector<std::pair<int, float>> creases; /* ray and sharpness, from the vertex outwards */
    float sharpness;                            /* of the vertex */
    /* The points' heights are those of a saddle plus a random number up to this; 0: random alone. */
    double gentle = 0;
};

/* The vertex is vertex 0. The face of sector k at the vertex is face 4 k, which is also its Ptex
 * face. */
class fan
{
  public:
    fan(const fan_shape &shape, uint64_t seed);
    fan(const fan &) = delete;
    fan &operator=(const fan &) = delete;

    struct cage cage = {};
    /* The cage's corner at the vertex in sector k; minus 16 k it is the corner of the Ptex face. */
    uint32_t corner(int sector) const;

  private:
    std::vector<std::array<double, 3>> position;
    std::vector<uint32_t> face_start, face_vertex;
    std::vector<cage_crease> creases;
    cage_corner sharp_vertex;
};

#endif
