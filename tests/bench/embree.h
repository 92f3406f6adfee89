/* The peer without a GPU: Embree 3 ray-traces the same cage as a subdivision surface, with 8
 * primary rays at a time, normals by rtcInterpolate, and one sample of the stripes for each
 * pixel. */
#ifndef SHEEN_TESTS_BENCH_EMBREE_H
#define SHEEN_TESTS_BENCH_EMBREE_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

extern "C" {
#include "server/cage/cage.h"
}
#include "tests/oracle/renderer.h"

struct embree_picture {
    std::vector<uint8_t> rgba;
    std::vector<float> normals; /* empty unless requested; NaN without a hit */
};

class embree_scene
{
  public:
    /* Builds the scene with n_threads threads. `rate` is the tessellation rate of every edge. */
    embree_scene(const cage &cage, unsigned rate, int n_threads);
    ~embree_scene();
    embree_scene(const embree_scene &) = delete;
    embree_scene &operator=(const embree_scene &) = delete;

    /* A perspective camera, one rectangle light with stripes by count. */
    void render(const frame_request &request, bool want_normals, embree_picture *picture) const;
    /* "Embree 3.13.5" */
    static std::string version();

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

/* The features of the cage that Embree does not support; empty: none. */
std::string embree_lacks(const cage &cage);

#endif
