/* The peer without a GPU: Embree 3 ray tracing the same cage as a subdivision surface, 8 primary
 * rays at a time, normals by rtcInterpolate, one sample of the stripes a pixel. */
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
    std::vector<float> normals; /* empty unless asked for; NaN where nothing is hit */
};

class embree_scene
{
  public:
    /* Builds the scene with so many threads. `rate` is the tessellation rate of every edge. */
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

/* What of the cage Embree has no word for; empty: nothing. */
std::string embree_lacks(const cage &cage);

#endif
