/* test_frames [--small] SHEEN|--library MODEL...: frames of every model from several views, judged
 * pixel by pixel. exactness.h judges P and N, coverage.h which pixels show which part of the
 * surface. --small: frames with a quarter of the pixels. --library: libsheen fetches the planes from
 * the daemon at $SHEEN_SERVER; EXR files would take half of the time of the daemon and of the test.
 */
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/coverage.h"
#include "tests/oracle/exactness.h"
#include "tests/oracle/frame_loop.h"

namespace
{

const char *const close_up = "zoom"; /* a view so close that test_zoom judges its P and N */

std::vector<view> views_of(const model &model, int width_px, int height_px)
{
    std::vector<view> views = model_views(model, width_px, height_px);
    views.push_back(zoomed_view(model, width_px, height_px));
    return views;
}

} // namespace

int main(int argc, char **argv)
{
    int first = argc > 1 && std::strcmp(argv[1], "--small") == 0 ? 2 : 1;
    if (argc < first + 2) {
        std::fprintf(stderr, "usage: test_frames [--small] SHEEN|--library MODEL...\n");
        return 2;
    }
    int width_px = first == 2 ? 320 : 640, height_px = first == 2 ? 240 : 480;
    verdict verdict;
    print_exactness_header();
    print_coverage_header();
    std::string path;
    std::unique_ptr<table_evaluator> tables;
    std::vector<std::string> models(argv + first + 1, argv + argc);
    auto views = [&](const model &model) { return views_of(model, width_px, height_px); };
    bool by_library = std::strcmp(argv[first], "--library") == 0;
    frame_source draw = by_library ? frames_by_library() : frames_by_command(argv[first]);
    for_each_frame(draw, list_models(models), views, &verdict,
                   [&](const model &model, const view &view, const planes &planes) {
                       if (path != model.path)
                           tables.reset(new table_evaluator(*model.cage));
                       path = model.path;
                       if (view.name != close_up)
                           judge_exactness(model, *tables, view, planes, &verdict);
                       judge_coverage(model, view, planes, &verdict);
                   });
    return verdict.finish();
}
