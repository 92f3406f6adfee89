/* Reads cages from files, changes them, and writes them as OBJ. */
#ifndef SHEEN_TESTS_ORACLE_CAGE_FILE_H
#define SHEEN_TESTS_ORACLE_CAGE_FILE_H

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/vec.h"

extern "C" {
#include "server/cage/cage.h"
}

/* Throws std::runtime_error with the path if the file cannot be read. */
std::shared_ptr<const struct cage> read_cage_file(const std::string &path);

/* A cage whose parts can be changed. */
struct loose_cage {
    std::vector<vec3> position;
    std::vector<std::vector<uint32_t>> faces;
    std::vector<cage_crease> creases;
    std::vector<cage_corner> corners;
    std::vector<uint32_t> holes;
    cage_boundary boundary = CAGE_BOUNDARY_EDGE_ONLY;
    bool chaikin = false, smooth_triangles = false;

    loose_cage() = default;
    explicit loose_cage(const cage &cage);
    /* Writes every number with 17 digits. Throws std::runtime_error on failure. */
    void write_obj(const std::string &path) const;
};

/* Provides a loose_cage as a struct cage, as long as this object lives. */
class solid_cage
{
  public:
    explicit solid_cage(const loose_cage &loose);
    solid_cage(const solid_cage &) = delete;
    solid_cage &operator=(const solid_cage &) = delete;
    struct cage cage = {};
    std::vector<uint32_t> first_ptex; /* of each face, and one past the last */

  private:
    loose_cage parts;
    std::vector<std::array<double, 3>> position;
    std::vector<uint32_t> face_start, face_vertex;
};

#endif
