/* Runs `sheen render` and reads back the planes of its EXR file. */
#ifndef SHEEN_TESTS_ORACLE_RENDER_H
#define SHEEN_TESTS_ORACLE_RENDER_H

#include <cstdint>
#include <string>
#include <vector>

#include "tests/oracle/folder.h"
#include "tests/oracle/vec.h"

const uint32_t no_face = 0xffffffffu;

/* The contents of a frame's file, top row first. Planes that were not requested are empty. */
struct planes {
    int width_px = 0, height_px = 0;
    /* The colour, sRGB with straight alpha; present only with the light or the coverage plane. */
    std::vector<float> red, green, blue, alpha;
    std::vector<float> coverage;
    std::vector<float> px, py, pz, nx, ny, nz, u, v, s, t, k_min, k_max;
    std::vector<float> dsdx, dsdy, dtdx, dtdy; /* changes of the light coordinates per pixel */
    std::vector<uint32_t> face;

    bool hit(size_t i) const
    {
        return face[i] != no_face;
    }
    vec3 position(size_t i) const
    {
        return {px[i], py[i], pz[i]};
    }
    vec3 normal(size_t i) const
    {
        return {nx[i], ny[i], nz[i]};
    }
};

/* Throws std::runtime_error when the file is
 * no EXR of one part, or a plane of `aov` (comma-separated, as in --aov) is missing or of another
 * type than promised. */
planes read_planes(const std::string &path, const std::string &aov);

struct program_result {
    int exit_code = -1; /* -1: could not be started, was killed or took too long */
    std::string output, errors;
};

/* Runs a program without a shell and waits for at most two minutes. */
program_result run_program(const std::vector<std::string> &arguments,
                           const temporary_folder &folder);

#endif
