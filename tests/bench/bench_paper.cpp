/* bench_paper: the measurements of Yasui and Kanai (2004). Stage one makes the tables of cages of
 * 300, 1,200 and 4,800 faces; position and colour are measured for 300x300, 500x500 and 700x700
 * fragments. The paper's own figures are for 700x700 on its GPU: 0.13 s and 0.52 s. The cage is a
 * wavy sheet with inner vertices of valence 3 and 5, drawn so large that it covers every pixel.
 * Position is visibility + evaluate, colour is shade. */
#include "tests/bench/question.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "tests/oracle/scene.h"
#include "tests/bench/sheet.h"
#include "tests/bench/timing.h"

namespace
{

const double paper_position_s = 0.13, paper_colour_s = 0.52;

void measure_tables(report *report)
{
    table table({"stage one", "faces", "irregular", "1 thread ms", "2 threads ms", "faces/s",
                 "bytes a face"});
    for (int n : {10, 20, 40}) {
        sheet sheet(3 * n, n, 48);
        auto build = [&](int n_threads) {
            return time_ms([&] { scene scene(sheet.cage(), n_threads); });
        };
        pair_of_samples pair = measure_pairs(
            report->given().runs, [&](int) { return build(1); }, [&](int) { return build(2); });
        double faces = 3.0 * n * n, ms = pair.b.median();
        scene scene(sheet.cage());
        table.row({"", count(faces), count((double)sheet.irregular()), number(pair.a.median(), 2),
                   number(ms, 2), count(faces / ms * 1000),
                   number((double)scene.bytes() / faces, 0)});
        report->figure(number(faces, 0) + " faces, 1 thread_ms", pair.a.median());
        report->figure(number(faces, 0) + " faces, 2 threads_ms", ms);
    }
    table.print();
}

void measure_fragments(report *report, const char *device)
{
    sheet sheet(60, 20, 48);
    scene scene(sheet.cage());
    drawing drawing(scene, device);
    note_device(report, drawing.info());
    table table({"fragments", "covered", "position ms", "colour ms", "both ms", "least", "wall ms",
                 "paper's position", "colour", "both", "times as fast"});
    for (uint32_t side : {300u, 500u, 700u}) {
        frame_request request = scene.request(side, side);
        sheet.fill_view(&request.camera);
        samples position, colour, both, wall;
        for (int run = 0; run <= report->given().runs; run++) {
            frame_request moved = request;
            moved.camera.target[0] += 1e-4 * run;
            frame_cost cost = drawing.cost(moved);
            if (run == 0)
                continue;
            position.add((double)(cost.stages.visibility_us + cost.stages.evaluate_us) / 1000);
            colour.add((double)cost.stages.shade_us / 1000);
            both.add(cost.stages_ms());
            wall.add(cost.wall_ms);
        }
        request.planes |= PLANE_NORMAL;
        frame frame = drawing.render(request);
        size_t covered = covered_pixels(frame);
        frame_finish(&frame);
        std::string of = std::to_string(side) + "x" + std::to_string(side);
        bool known = side == 700;
        double paper_ms = 1000 * (paper_position_s + paper_colour_s);
        table.row({of, count((double)covered), number(position.median(), 1),
                   number(colour.median(), 1), number(both.median(), 1), number(both.least(), 1),
                   number(wall.median(), 1), known ? number(1000 * paper_position_s, 0) : "",
                   known ? number(1000 * paper_colour_s, 0) : "", known ? number(paper_ms, 0) : "",
                   known ? number(paper_ms / both.median(), 1) : ""});
        report->figure(of + " position_ms", position.median());
        report->figure(of + " colour_ms", colour.median());
        report->figure(of + " both_ms", both.median());
        report->figure(of + " wall_ms", wall.median());
        report->figure(of + " least both_ms", both.least());
        report->figure(of + " covered pixels", (double)covered);
        if (known)
            report->figure(of + " paper/ours ratio", paper_ms / both.median());
    }
    table.print();
}

void ask(report *report)
{
    measure_tables(report);
    measure_fragments(report, report->given().device().c_str());
}

const question paper("paper", "the measurements of Yasui and Kanai (2004)", {"device"}, ask);

} // namespace
