/* bench_tables: the time of our tables against OpenSubdiv's refiner, adaptive refinement and patch
 * table of the same cage, at isolation levels 6 and 10. OpenSubdiv builds on one core; ours are
 * measured on one and on two. Our tables are exact to level 32 and more. "ours" holds the points of
 * all levels, as the GL device takes them. "on demand" is what the native device takes: a plan (on
 * one thread), the nodes and the outline, which the default camera needs; the points of a level are
 * made when a view shows it. OpenSubdiv's table holds indices and the stencils of its end caps, so
 * the time to refine its points level by level is included. */
#include "tests/bench/peers.h"
#include "tests/bench/question.h"
#include "tests/oracle/cage_file.h"

#include <stdexcept>

extern "C" {
#include "server/surface/support.h"
}

namespace
{

/* All that a model needs before its first frame on the native device. */
void build_on_demand(const cage &cage, int n_threads)
{
    error error;
    limit_tables tables = build_tables(cage, true, n_threads);
    if (!limit_find_support(&tables, NULL, &error))
        throw std::runtime_error(error.text);
    limit_tables_finish(&tables);
}

void measure(report *report, table *table, const std::string &path, int n_threads)
{
    std::shared_ptr<const cage> cage = read_cage_file(path);
    const std::vector<tables_peer> peers = tables_peers();
    std::vector<timed_call> calls = {
        [&](int) { return time_ms([&] { scene scene(cage, n_threads); }); },
        [&](int) { return time_ms([&] { build_on_demand(*cage, n_threads); }); }};
    for (const tables_peer &peer : peers)
        calls.push_back([&](int) { return time_ms([&] { peer.build(*cage); }); });
    std::vector<turn> turns = measure_in_turn(report->given().runs, calls);

    double faces = (double)cage->n_faces, ours = turns[0].ms.median();
    double on_demand = turns[1].ms.median();
    std::string threads = std::to_string(n_threads);
    std::string key = model_name(path) + " threads " + threads + " ";
    report->figure(key + "tables_ms", ours);
    report->figure(key + "tables_on_demand_ms", on_demand);
    const std::vector<std::string> cells = {model_name(path),
                                            count(faces),
                                            threads,
                                            number(ours, 2),
                                            number(turns[0].ms.least(), 2),
                                            count(faces / ours * 1000),
                                            number(on_demand, 2),
                                            number(turns[1].ms.least(), 2)};
    if (peers.empty())
        table->row(cells);
    for (size_t i = 0; i < peers.size(); i++) {
        const turn &theirs = turns[i + 2];
        std::vector<std::string> row = cells;
        row.insert(row.end(),
                   {peers[i].name, number(theirs.ms.median(), 2), number(theirs.ms.least(), 2),
                    count(faces / theirs.ms.median() * 1000), number(theirs.ratio.median(), 2)});
        table->row(row);
        report->figure(key + peers[i].name + "_ms", theirs.ms.median());
        report->figure(key + peers[i].name + "/tables ratio", theirs.ratio.median());
    }
}

void ask(report *report)
{
    std::vector<std::string> headings = {"tables", "faces",   "threads",      "ours ms",
                                         "least",  "faces/s", "on demand ms", "least"};
    if (!tables_peers().empty())
        headings.insert(headings.end(), {"peer", "ms", "least", "faces/s", "ratio"});
    table table(headings);
    for (const std::string &path : bench_models(report->given()))
        for (int n_threads : {1, 2})
            measure(report, &table, path, n_threads);
    table.print();
}

const question tables("tables", "faces a second of each model, on one core and on two", {}, ask);

} // namespace
