/* bench_closeup: whether a frame takes longer when an extraordinary vertex fills it. The camera
 * approaches an extraordinary vertex of a sheet; alternately the same frame of a regular sheet is
 * drawn, at 1280x720. The printed share is that of pixels that show a face with such a vertex. */
#include "tests/bench/question.h"

#include "tests/oracle/scene.h"
#include "tests/bench/sheet.h"
#include "tests/bench/timing.h"

namespace
{

double share_of_corners(drawing *drawing, const limit_tables &tables, frame_request request)
{
    request.planes |= PLANE_PTEX;
    frame frame = drawing->render(request);
    const uint32_t *ptex = (const uint32_t *)frame.plane[3];
    size_t pixels = (size_t)request.width_px * request.height_px, corners = 0;
    for (size_t i = 0; i < pixels; i++)
        corners += ptex[3 * i] < tables.n_faces && tables.nodes[ptex[3 * i]].kind != LIMIT_REGULAR;
    frame_finish(&frame);
    return (double)corners / (double)pixels;
}

void ask(report *report)
{
    std::string device = report->given().device();
    sheet irregular(60, 20, 48), regular(60, 20, 0);
    scene corner_scene(irregular.cage()), plain_scene(regular.cage());
    drawing corner(corner_scene, device.c_str()), plain(plain_scene, device.c_str());
    note_device(report, corner.info());
    table table(
        {"distance", "share of corners", "ms", "least", "all regular ms", "least", "regular/ours"});
    frame_request request = corner_scene.request(1280, 720);
    for (double distance : {1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4}) {
        auto view = [&](int run) {
            irregular.close_up(distance * (1 + 1e-4 * run), &request.camera);
            return request;
        };
        pair_of_samples pair = measure_pairs(
            report->given().runs, [&](int run) { return corner.cost(view(run)).stages_ms(); },
            [&](int run) { return plain.cost(view(run)).stages_ms(); });
        double share = share_of_corners(&corner, corner_scene.tables, view(0));
        table.row({number(distance, 4), number(share, 3), number(pair.a.median(), 1),
                   number(pair.a.least(), 1), number(pair.b.median(), 1), number(pair.b.least(), 1),
                   number(pair.ratio.median(), 2)});
        std::string key = number(distance, 4) + " ";
        report->figure(key + "share", share);
        report->figure(key + "frame_ms", pair.a.median());
        report->figure(key + "regular_ms", pair.b.median());
        report->figure(key + "regular/frame ratio", pair.ratio.median());
    }
    table.print();
}

const question closeup("closeup",
                       "close-ups: the share of the screen that a corner fills against time",
                       {"device"}, ask);

} // namespace
