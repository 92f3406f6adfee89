/* Finds where many rays of each pixel meet a model's surface: the exact positions and normals of an
 * enlarged frame, rendered in this process. Does not include lines.h, whose names collide with the
 * renderer's. */
#ifndef SHEEN_TESTS_ORACLE_SURFACE_GRID_H
#define SHEEN_TESTS_ORACLE_SURFACE_GRID_H

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/view.h"

struct surface_grid {
    size_t width = 0, height = 0;
    std::vector<std::array<float, 3>> positions,
        normals; /* top row first; NaN where the ray misses */

    bool hit(size_t i) const
    {
        return std::isfinite(normals[i][0]);
    }
    vec3 position(size_t i) const
    {
        return {positions[i][0], positions[i][1], positions[i][2]};
    }
    vec3 normal(size_t i) const
    {
        return {normals[i][0], normals[i][1], normals[i][2]};
    }
};

/* A model with its own renderer. Only one at a time, because renderers share their thread's
 * context. */
class grid_model
{
  public:
    /* Throws std::runtime_error if the file is not a cage. */
    explicit grid_model(const std::string &path);
    ~grid_model();
    grid_model(const grid_model &) = delete;
    grid_model &operator=(const grid_model &) = delete;

    /* `side` x `side` rays for each pixel. */
    surface_grid sample(const view &view, int side);

    std::string path;
    vec3 box_min, box_max;

  private:
    struct parts;
    std::unique_ptr<parts> own;
};

#endif
