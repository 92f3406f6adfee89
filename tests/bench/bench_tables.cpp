/* bench_tables: how long our tables take against OpenSubdiv's refiner, adaptive refinement and
 * patch table of the same cage, at isolation levels 6 and 10. OpenSubdiv builds on one core; ours
 * stand beside it on one and on two. Ours are exact to level 32 and more, and hold points;
 * OpenSubdiv's table holds indices and the stencils of its end caps, so that its points, refined
 * level by level, are part of its time. */
#include "tests/bench/bench.h"

#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/stencilTable.h>

#include "tests/oracle/scene.h"
#include "tests/oracle/model.h"
#include "tests/oracle/osd_refiner.h"

namespace Far = OpenSubdiv::Far;

namespace
{

/* libosd's own choice for a user who draws: Gregory end caps, single precision. */
void build_patch_table(const cage &cage, int level)
{
    auto refiner = make_refiner(cage);
    Far::PatchTableFactory::Options options((unsigned)level);
    options.useInfSharpPatch = true;
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    std::unique_ptr<Far::PatchTable> table(Far::PatchTableFactory::Create(*refiner, options));
    std::vector<control_point> points((size_t)refiner->GetNumVerticesTotal() +
                                      (size_t)table->GetNumLocalPoints());
    for (size_t i = 0; i < cage.n_vertices; i++)
        points[i].p = {cage.position[i][0], cage.position[i][1], cage.position[i][2]};
    Far::PrimvarRefiner primvar(*refiner);
    control_point *source = points.data();
    for (int k = 1; k < refiner->GetNumLevels(); k++) {
        control_point *target = source + refiner->GetLevel(k - 1).GetNumVertices();
        primvar.Interpolate(k, source, target);
        source = target;
    }
    if (table->GetNumLocalPoints() > 0)
        table->GetLocalPointStencilTable()->UpdateValues(
            points.data(), points.data() + refiner->GetNumVerticesTotal());
}

void measure(report *report, table *table, const std::string &path)
{
    std::shared_ptr<const cage> cage = read_cage_file(path);
    std::string name = model_name(path);
    for (int level : {6, 10})
        for (int n_threads : {1, 2}) {
            pair_of_samples pair = measure_pairs(
                report->given().runs,
                [&](int) { return time_ms([&] { scene scene(cage, n_threads); }); },
                [&](int) { return time_ms([&] { build_patch_table(*cage, level); }); });
            double faces = (double)cage->n_faces, ours = pair.a.median();
            std::string threads = std::to_string(n_threads), of = std::to_string(level);
            table->row({name, count(faces), threads, number(ours, 2), count(faces / ours * 1000),
                        of, number(pair.b.median(), 2), count(faces / pair.b.median() * 1000),
                        number(pair.a.least(), 2), number(pair.b.least(), 2),
                        number(pair.ratio.median(), 2)});
            std::string key = name + " threads " + threads + " level " + of + " ";
            report->figure(key + "tables_ms", ours);
            report->figure(key + "opensubdiv_ms", pair.b.median());
            report->figure(key + "opensubdiv/tables ratio", pair.ratio.median());
        }
}

} // namespace

int main(int argc, char **argv)
{
    return bench_main("bench_tables", [&] {
        report report("bench_tables", argc, argv);
        table table({"tables", "faces", "threads", "ours ms", "faces/s", "level", "OpenSubdiv ms",
                     "faces/s", "least", "OpenSubdiv's", "ratio"});
        for (const std::string &path : bench_models(report.given()))
            measure(&report, &table, path);
        table.print();
        report.finish();
    });
}
