/* bench_comparison: comparing a model with itself, with one vertex moved, and with its vertices renumbered, by a million
 * samples, on one thread and on two; the largest memory that the process has taken. */
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <sys/resource.h>

#include "tests/bench/question.h"
#include "tests/oracle/cage_file.h"

using std::atomic_bool; /* what <stdatomic.h> gives C */
extern "C" {
#include "server/curves/compare/comparison.h"
#include "server/surface/subdivision/build.h"
}

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
    for (unsigned phase = 0; computation && computation->kind->stages[phase]; phase++) {
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

void measure(report *report, table *table, const std::string &path)
{
    loose_cage cage(*read_cage_file(path)), moved = cage;
    moved.position[moved.position.size() / 5].z += 0.01;
    const std::vector<std::pair<std::string, loose_cage>> others = {
        {"same", cage}, {"moved", moved}, {"renumbered", renumbered(cage)}};
    limit_tables before;
    build(cage, &before);
    for (const auto &[name, other] : others) {
        limit_tables after;
        build(other, &after);
        comparison_setup setup =
            setup_of(&before, &after, std::stoul(report->given().other("samples", usual_samples)));
        std::vector<turn> turns = measure_in_turn(
            report->given().runs, {[&](int) { return time_ms([&] { run(setup, 1); }); },
                                   [&](int) { return time_ms([&] { run(setup, 2); }); }});
        struct rusage usage;
        getrusage(RUSAGE_SELF, &usage);
        double one = turns[0].ms.median(), two = turns[1].ms.median();
        table->row({model_name(path), name, number(one, 0), number(two, 0),
                    number((double)usage.ru_maxrss / 1024, 0)});
        std::string key = model_name(path) + " " + name + " ";
        report->figure(key + "1_thread_ms", one);
        report->figure(key + "2_threads_ms", two);
        limit_tables_finish(&after);
    }
    limit_tables_finish(&before);
}

void ask(report *report)
{
    table table({"comparison", "other", "1 thread ms", "2 threads ms", "MB at most"});
    for (const std::string &path : bench_models(report->given()))
        measure(report, &table, path);
    table.print();
}

const question comparison("comparison", "a million samples against another surface", {"samples"},
                          ask);

} // namespace
