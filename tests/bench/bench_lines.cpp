/* bench_lines: the time on one core to trace 41 lines of a plane, a tunnel and a zebra as curves, with an eye at a finite
 * distance, and how many squares were not decided. */
#include "tests/bench/question.h"
#include "tests/oracle/cage_file.h"
#include "tests/oracle/tables.h"

#include <atomic>
#include <cstring>
#include <memory>
#include <stdexcept>

using std::atomic_bool; /* what <stdatomic.h> gives C */
extern "C" {
#include "server/curves/lines/surface_lines.h"
}

namespace
{

const int n_lines = 41;

struct view {
    double middle[3], size;
};

view view_of(const limit_tables &tables)
{
    view seen = {{0, 0, 0}, 0};
    for (int k = 0; k < 3; k++) {
        seen.middle[k] = 0.5 * (tables.box_min[k] + tables.box_max[k]);
        seen.size = std::max(seen.size, tables.box_max[k] - tables.box_min[k]);
    }
    return seen;
}

/* Lines across the light that the model sees. */
std::unique_ptr<line_set> lines_of(const std::string &kind, const view &seen)
{
    auto set = std::make_unique<line_set>();
    std::memset(set.get(), 0, sizeof *set);
    lines lines = {};
    lines.family = kind == "zebra" ? LINES_ZEBRA : LINES_REFLECTION;
    lines.has_direction = kind == "zebra";
    lines.direction[2] = 1;
    lines.eye_kind = LINE_EYE_POINT;
    const double from[3] = {0.8, -1.6, 1.1};
    light light = {};
    light.kind = kind == "tunnel" ? LIGHT_TUNNEL : LIGHT_PLANE;
    for (int k = 0; k < 3; k++) {
        lines.eye[k] = seen.middle[k] + from[k] * seen.size;
        light.centre[k] = seen.middle[k];
    }
    light.u[kind == "tunnel" ? 2 : 0] = 1.5 * seen.size;
    light.v[kind == "tunnel" ? 0 : 1] = seen.size;
    if (kind == "plane")
        light.centre[2] += 1.5 * seen.size;
    line_map map;
    line_map_init(&map, &lines, &light);
    for (int i = 0; i < n_lines; i++)
        line_set_add(set.get(), &map, 0, (i + 0.5) / n_lines);
    return set;
}

void measure(report *report, table *table, const std::string &path, const std::string &kind)
{
    table_evaluator evaluator(*read_cage_file(path));
    const view seen = view_of(evaluator.tables);
    const std::unique_ptr<line_set> set = lines_of(kind, seen);
    surface_lines_result result = {};
    surface_lines *traced = nullptr;
    samples ms;
    for (int run = 0; run < report->given().runs;
         run++) { /* none to warm up: a run takes seconds */
        if (traced)
            computation_destroy(surface_lines_computation(traced));
        double taken = time_ms([&] {
            error error = {};
            traced = surface_lines_create(&evaluator.tables, set.get(), 1e-4 * seen.size,
                                          (size_t)1 << 31, &error);
            if (!traced || !computation_run(surface_lines_computation(traced), &error))
                throw std::runtime_error(error.text);
        });
        ms.add(taken);
    }
    result = surface_lines_get(traced);
    std::string key = model_name(path) + " " + kind + " ";
    report->figure(key + "lines_ms", ms.median());
    report->figure(key + "undecided", (double)result.n_marks);
    table->row({model_name(path), kind, number(ms.median(), 0), number(ms.least(), 0),
                count((double)result.n_cells), count((double)result.curves->n_curves),
                count((double)result.curves->n_points), count((double)result.n_marks)});
    computation_destroy(surface_lines_computation(traced));
}

void ask(report *report)
{
    table table({"41 lines", "light", "ms", "least", "squares", "curves", "points", "undecided"});
    for (const std::string &path : bench_models(report->given()))
        for (const char *kind : {"plane", "tunnel", "zebra"})
            measure(report, &table, path, kind);
    table.print();
}

const question lines_question("lines", "the time to trace 41 lines as curves on one core", {}, ask);

} // namespace
