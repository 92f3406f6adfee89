/* A cage file, its oracle, and the size of its limit surface. */
#ifndef SHEEN_TESTS_ORACLE_MODEL_H
#define SHEEN_TESTS_ORACLE_MODEL_H

#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/osd_oracle.h"

struct model {
    std::string path, name; /* name: the file without its folder */
    std::shared_ptr<const struct cage> cage;
    std::unique_ptr<osd_oracle> oracle;
    vec3 box_min, box_max; /* box of limit positions, sampled 9 x 9 on every Ptex face */

    vec3 middle() const
    {
        return 0.5 * (box_min + box_max);
    }
    double diagonal() const
    {
        return length(box_max - box_min);
    }
};

/* Throws as read_cage_file(), and if the cage cannot be evaluated. */
model read_model(const std::string &path);

/* The same cage with another boundary mode. Throws if that leaves no surface. */
model with_boundary(const model &model, cage_boundary boundary);

/* The existing model files among the arguments. A folder stands for its Catmull-Clark cages,
 * sorted: every .obj, .gltf and .glb, except those whose names say that they have another scheme
 * (loop_*, bilinear_*) or are not manifold (*nonman*); these are counted and skipped. Missing files
 * are named on standard output and skipped. */
std::vector<std::string> list_models(const std::vector<std::string> &arguments);

#endif
