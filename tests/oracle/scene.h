/* A cage, its tables, and a renderer in this process, without a daemon. */
#ifndef SHEEN_TESTS_ORACLE_SCENE_H
#define SHEEN_TESTS_ORACLE_SCENE_H

#include <memory>
#include <string>

#include "tests/oracle/renderer.h"

/* The number of threads with which the daemon builds tables on the machine of RESULTS.md, and which
 * every peer gets. */
const int bench_threads = 2;

/* Builds the tables of all faces as the daemon's pool does: idle threads take ranges of 16 faces. Throws
 * std::runtime_error if memory is short. */
void build_all_faces(limit_tables *tables, const struct limit_plan *plan, int n_threads);

/* A cage's tables, as the GL device takes them. */
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

/* A renderer with one scene's tables on its device. */
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
};

/* Turns the eye around the target about up. Frames of different cameras share no planes. */
void orbit(camera *camera, double degrees);

/* The number of pixels that show the surface, by the frame's normals. */
size_t covered_pixels(const frame &frame);

#endif
