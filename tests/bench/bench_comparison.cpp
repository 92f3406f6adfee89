/* bench_comparison [--all 1] [--samples N]: a million samples of a model against the model with one vertex moved, on two threads; the largest memory
 * that the process has taken by then; and, in turn with it, what a comparison by pictures takes: four views of both models
 * of 1920 x 1080, drawn by the native device, and their pixels. --all 1: also against itself and with faces renumbered. */
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <thread>
#include <sys/resource.h>

#include "tests/bench/question.h"
#include "tests/oracle/cage_file.h"
#include "tests/oracle/scene.h"

using std::atomic_bool;                  /* what <stdatomic.h> gives C */
#define line_family renderer_line_family /* as in tests/oracle/renderer.h */
extern "C" {
#include "server/curves/compare/comparison.h"
#include "server/surface/subdivision/build.h"
}
#undef line_family

namespace
{

const char *const usual_samples = "1000000";

void build(const loose_cage &parts, limit_tables *tables)
{
    solid_cage solid(parts);
    error error = {};
    limit_plan *plan = limit_plan_create(&solid.cage, nullptr, &error);
    if (!plan || !limit_tables_init_on_demand(tables, limit_plan_size(plan), &error) ||
        !limit_build_faces(tables, plan, 0, tables->n_faces, nullptr, &error))
        throw std::runtime_error(error.text);
    limit_plan_destroy(plan);
}

/* Runs all phases; threads take the slices of a phase one after the other. */
void run(const comparison_setup &setup, int n_threads)
{
    error error = {};
    computation *computation = comparison_create(&setup, &error);
    for (unsigned phase = 0; computation && computation->kind->stages[phase];
         phase += !computation_repeats(computation)) {
        size_t n_slices = 0;
        if (!computation->kind->begin(computation, phase, &n_slices, &error))
            throw std::runtime_error(error.text);
        std::atomic<size_t> next{0};
        auto work = [&] {
            for (size_t slice; (slice = next++) < n_slices;)
                computation->kind->slice(computation, slice);
        };
        std::vector<std::thread> others;
        for (int k = 1; k < n_threads; k++)
            others.emplace_back(work);
        work();
        for (std::thread &thread : others)
            thread.join();
    }
    computation_destroy(computation);
}

comparison_setup setup_of(const limit_tables *before, const limit_tables *after, size_t n_samples)
{
    comparison_setup setup = {};
    double size = 0;
    lines lines = {};
    light light = {};
    for (int k = 0; k < 3; k++)
        size = std::hypot(size, before->box_max[k] - before->box_min[k]);
    lines.eye_kind = LINE_EYE_POINT;
    lines.eye[0] = lines.eye[2] = 2 * size;
    light.kind = LIGHT_TUNNEL;
    light.u[2] = 3 * size;
    light.v[0] = size;
    light.pattern.count = 40;
    setup.tables[0] = before;
    setup.tables[1] = after;
    setup.n_lights = 1;
    line_map_init(&setup.lights[0], &lines, &light);
    setup.limit[COMPARISON_DISTANCE] = 1e-5 * size;
    setup.limit[COMPARISON_NORMAL] = 0.05;
    setup.limit[COMPARISON_LINES] = 0.1;
    setup.limit[COMPARISON_LINE_LENGTH] = setup.limit[COMPARISON_CURVATURE] = INFINITY;
    setup.n_samples = n_samples;
    setup.most_bytes = 300 << 20;
    return setup;
}

/* The same cage with its faces in reverse order: no place keeps its number. */
loose_cage renumbered(loose_cage cage)
{
    std::vector<std::vector<uint32_t>> faces(cage.faces.rbegin(), cage.faces.rend());
    if (cage.holes.empty())
        cage.faces = faces;
    return cage;
}

/* A vertex is moved. */
loose_cage moved(loose_cage cage)
{
    cage.position[cage.position.size() / 5].z += 0.01;
    return cage;
}

std::shared_ptr<const cage> solid_of(const loose_cage &parts)
{
    auto solid = std::make_shared<solid_cage>(parts);
    return std::shared_ptr<const cage>(solid, &solid->cage);
}

/* What a comparison by pictures takes: both models in four views of 1920 x 1080, and the pixels that differ. The models'
 * tables are ready, as those of the comparison. */
class pictures
{
  public:
    pictures(const loose_cage &before, const loose_cage &after)
        : scenes{scene(solid_of(before)), scene(solid_of(after))},
          drawings{drawing(scenes[0], "native"), drawing(scenes[1], "native")},
          request(scenes[0].request(1920, 1080))
    {
    }
    pictures(const pictures &) = delete;
    pictures &operator=(const pictures &) = delete;

    /* Returns the number of pixels that differ. */
    size_t compare()
    {
        size_t n = 0;
        for (int view = 0; view < 4; view++) {
            orbit(&request.camera, 90);
            frame frames[2] = {drawings[0].render(request), drawings[1].render(request)};
            for (size_t i = 0; i < (size_t)request.width_px * request.height_px; i++)
                n += std::memcmp((const uint8_t *)frames[0].plane[0] + 4 * i,
                                 (const uint8_t *)frames[1].plane[0] + 4 * i, 4) != 0;
            frame_finish(&frames[0]);
            frame_finish(&frames[1]);
        }
        return n;
    }

  private:
    scene scenes[2];
    drawing drawings[2];
    frame_request request;
};

double most_mb()
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024;
}

void measure(report *report, table *table, const std::string &path, const std::string &what)
{
    loose_cage cage(*read_cage_file(path));
    loose_cage other = what == "moved"        ? moved(cage)
                       : what == "renumbered" ? renumbered(cage)
                                              : cage;
    limit_tables before, after;
    build(cage, &before);
    build(other, &after);
    comparison_setup setup =
        setup_of(&before, &after, std::stoul(report->given().other("samples", usual_samples)));
    run(setup, 2);
    double mb = most_mb(); /* before there are renderers */
    pictures peer(cage, other);
    size_t n_pixels = 0;
    std::vector<turn> turns = measure_in_turn(
        report->given().runs, {[&](int) { return time_ms([&] { run(setup, 2); }); },
                               [&](int) { return time_ms([&] { n_pixels = peer.compare(); }); }});
    double two = turns[0].ms.median(), pixels = turns[1].ms.median(),
           ratio = turns[1].ratio.median();
    table->row({model_name(path), what, number(two, 0), number(mb, 0), number(pixels, 0),
                number((double)n_pixels, 0), number(ratio, 2)});
    std::string key = model_name(path) + " " + what + " ";
    report->figure(key + "2_threads_ms", two);
    report->figure(key + "4_views_ms", pixels);
    report->figure(key + "4_views/comparison ratio", ratio);
    limit_tables_finish(&after);
    limit_tables_finish(&before);
}

void ask(report *report)
{
    table table({"comparison", "other", "2 threads ms", "MB at most", "4 views ms", "pixels",
                 "views/comparison"});
    const bool is_all = report->given().other("all", "0") == "1";
    for (const std::string &path : bench_models(report->given()))
        for (const char *what : {"moved", "same", "renumbered"})
            if (is_all || std::string(what) == "moved")
                measure(report, &table, path, what);
    table.print();
}

const question comparison("comparison", "a million samples against four pictures of both models",
                          {"all", "samples"}, ask);

} // namespace
