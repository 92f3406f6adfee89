#include "tests/oracle/scene.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <vector>

extern "C" {
#include "server/surface/subdivision/build.h"
}
#include "tests/oracle/vec.h"

namespace
{

void check(bool ok, const error &error)
{
    if (!ok)
        throw std::runtime_error(error.text);
}

void build_all_faces(limit_tables *tables, const limit_plan *plan, int n_threads)
{
    const size_t range = 16;
    std::vector<error> errors((size_t)n_threads);
    std::vector<char> built((size_t)n_threads, true);
    std::atomic<size_t> next{0};
    auto work = [&](size_t k) {
        for (size_t first; built[k] && (first = next.fetch_add(range)) < tables->n_faces;)
            built[k] = limit_build_faces(
                tables, plan, first, std::min(first + range, tables->n_faces), NULL, &errors[k]);
    };
    std::vector<std::thread> others;
    for (size_t k = 1; k < errors.size(); k++)
        others.emplace_back(work, k);
    work(0);
    for (std::thread &thread : others)
        thread.join();
    for (size_t k = 0; k < errors.size(); k++)
        check(built[k], errors[k]);
}

vec3 from(const double a[3])
{
    return {a[0], a[1], a[2]};
}

} // namespace

limit_tables build_tables(const struct cage &cage, bool on_demand, int n_threads)
{
    error error;
    limit_tables tables = {};
    std::unique_ptr<limit_plan, void (*)(limit_plan *)> plan(limit_plan_create(&cage, NULL, &error),
                                                             limit_plan_destroy);
    check(plan != nullptr, error);
    const limit_size *size = limit_plan_size(plan.get());
    check(on_demand ? limit_tables_init_on_demand(&tables, size, &error)
                    : limit_tables_init(&tables, size, &error),
          error);
    build_all_faces(&tables, plan.get(), n_threads);
    return tables;
}

scene::scene(std::shared_ptr<const struct cage> whose, int n_threads)
    : cage(std::move(whose)), tables(build_tables(*cage, false, n_threads))
{
}

scene::~scene()
{
    limit_tables_finish(&tables);
}

frame_request scene::request(uint32_t width_px, uint32_t height_px) const
{
    frame_request request = {};
    request.width_px = width_px;
    request.height_px = height_px;
    request.n_lights = 1;
    pattern &pattern = request.lights[0].pattern;
    pattern.kind = PATTERN_STRIPES;
    pattern.count = 40;
    pattern.duty = 0.5;
    pattern.opacity = 1;
    for (int i = 0; i < 4; i++)
        pattern.foreground[i] = 1;
    pattern.background[3] = 1;
    request.planes = PLANE_COLOUR;
    scene_default_camera(&tables, nullptr, VIEW_AROUND, width_px, height_px, &request.camera);
    scene_default_light(tables.box_min, tables.box_max, nullptr, &request.lights[0]);
    return request;
}

static const char *test_isa()
{
    const char *isa = std::getenv("SHEEN_TEST_ISA");
    return isa && std::strcmp(isa, "auto") != 0 ? isa : nullptr;
}

drawing::drawing(const scene &scene, const char *device, const char *isa)
    : renderer(nullptr), model(nullptr)
{
    error error;
    device_try tries[DEVICE_MOST_TRIES];
    int n = device_tries(device, tries);
    if (n == 0)
        error_set(&error, ERROR_REQUEST,
                  "device is '%s'; it must be auto, software, native or a device's number", device);
    bool takes_on_demand = false;
    for (int i = 0; i < n && !renderer; i++) {
        renderer_options options = {};
        options.device = tries[i].device;
        options.isa = isa;
        renderer = renderer_create(tries[i].kind, &options, &error);
        takes_on_demand = renderer_takes_tables_on_demand(tries[i].kind);
    }
    check(renderer != nullptr, error);
    if (takes_on_demand)
        on_demand = build_tables(*scene.cage, true, bench_threads);
    model = renderer_model_create(renderer, takes_on_demand ? &on_demand : &scene.tables, &error);
    if (!model)
        renderer_destroy(renderer);
    check(model != nullptr, error);
}

drawing::drawing(const scene &scene)
    : drawing(scene, std::getenv("SHEEN_TEST_DEVICE") ? std::getenv("SHEEN_TEST_DEVICE") : "native",
              test_isa())
{
}

drawing::~drawing()
{
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&on_demand);
}

frame drawing::render(const frame_request &request)
{
    error error;
    frame frame;
    check(renderer_render(renderer, model, &request, &frame, &error), error);
    return frame;
}

frame_cost drawing::cost(const frame_request &request)
{
    using clock = std::chrono::steady_clock;
    clock::time_point start = clock::now();
    frame frame = render(request);
    std::chrono::duration<double, std::milli> all = clock::now() - start;
    frame_cost cost = {frame.times, all.count(),
                       all.count() - (double)frame.times.readback_us / 1000};
    frame_finish(&frame);
    return cost;
}

void orbit(camera *camera, double degrees)
{
    vec3 axis = normalized(from(camera->up)), arm = from(camera->eye) - from(camera->target);
    double angle = degrees * M_PI / 180, along = dot(axis, arm) * (1 - std::cos(angle));
    vec3 eye = from(camera->target) + std::cos(angle) * arm + std::sin(angle) * cross(axis, arm) +
               along * axis;
    camera->eye[0] = eye.x;
    camera->eye[1] = eye.y;
    camera->eye[2] = eye.z;
}

size_t covered_pixels(const frame &frame)
{
    const float *normals = (const float *)frame.plane[2];
    size_t pixels = (size_t)frame.width_px * frame.height_px, covered = 0;
    for (size_t i = 0; i < pixels; i++)
        covered += !std::isnan(normals[3 * i]);
    return covered;
}
