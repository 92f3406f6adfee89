/* A cage, its tables, and a renderer in this process, without a daemon. */
#ifndef SHEEN_TESTS_ORACLE_SCENE_H
#define SHEEN_TESTS_ORACLE_SCENE_H

#include <memory>
#include <string>

#include "tests/oracle/renderer.h"

/* The number of threads with which the daemon builds tables on the machine of RESULTS.md, and which
 * every peer gets. */
const int bench_threads = 2;

/* All tables of a cage; idle threads take ranges of 16 faces, as in the daemon's pool. `on_demand` is
 * what the native device takes; GL's devices take all points. The caller frees them by
 * limit_tables_finish(). Throws std::runtime_error if the cage is refused. */
limit_tables build_tables(const struct cage &cage, bool on_demand, int n_threads);

/* A cage with tables of all points. */
class scene
{
  public:
    /* Throws std::runtime_error if the cage is refused. */
    explicit scene(std::shared_ptr<const struct cage> whose, int n_threads = bench_threads);
    ~scene();
    scene(const scene &) = delete;
    scene &operator=(const scene &) = delete;

    /* A request with sheen's default camera and light, 40 stripes, colour only. */
    frame_request request(uint32_t width_px, uint32_t height_px) const;
    size_t bytes() const
    {
        return limit_tables_bytes(&tables);
    }

    const std::shared_ptr<const struct cage> cage;
    limit_tables tables = {};
};

/* The cost of a frame. */
struct frame_cost {
    frame_times stages;
    double all_ms;  /* elapsed time from the request to the planes in memory */
    double wall_ms; /* elapsed time without the readback */

    /* The time of visibility, evaluate and shade, in milliseconds. */
    double stages_ms() const
    {
        return (double)(stages.visibility_us + stages.evaluate_us + stages.shade_us) / 1000;
    }
};

/* A renderer with one scene's model on its device, from tables of the kind that the device takes. */
class drawing
{
  public:
    /* `device` as sheend's --device, `isa` as renderer_options. */
    drawing(const scene &scene, const char *device, const char *isa = nullptr);
    /* On the device that the tests judge, from the environment: SHEEN_TEST_DEVICE (native) and
     * SHEEN_TEST_ISA. */
    explicit drawing(const scene &scene);
    ~drawing();
    drawing(const drawing &) = delete;
    drawing &operator=(const drawing &) = delete;

    const struct renderer_info &info() const
    {
        return *renderer_info(renderer);
    }
    /* The caller frees the frame by frame_finish(). */
    frame render(const frame_request &request);
    /* Renders and drops the picture. */
    frame_cost cost(const frame_request &request);

  private:
    struct renderer *renderer;
    struct renderer_model *model;
    limit_tables on_demand = {}; /* if the device takes them */
};

/* Turns the eye around the target about up. Frames of different cameras share no planes. */
void orbit(camera *camera, double degrees);

/* The number of pixels that show the surface, by the frame's normals. */
size_t covered_pixels(const frame &frame);

#endif
