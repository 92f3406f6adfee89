/* bench_light: the time of a frame in which only the light changed, against that of a full frame:
 * both elapsed times, including reading the picture back, measured alternately on the same view. */
#include "tests/bench/question.h"

#include "tests/bench/timing.h"
#include "tests/oracle/cage_file.h"
#include "tests/oracle/scene.h"

namespace
{

void measure(report *report, table *table, const std::string &path, const char *device)
{
    scene scene(read_cage_file(path));
    drawing drawing(scene, device);
    frame_request request = scene.request(1920, 1080);
    note_device(report, drawing.info());
    auto render = [&] { return drawing.cost(request).all_ms; };
    pair_of_samples pair = measure_pairs(
        report->given().runs,
        [&](int run) {
            orbit(&request.camera, run % 2 ? 0.1 : -0.1);
            return render();
        },
        [&](int run) {
            request.lights[0].pattern.offset = 0.01 * run + 0.005;
            return render();
        });
    std::string name = model_name(path);
    table->row({name, "1920x1080", number(pair.a.median(), 1), number(pair.b.median(), 1),
                number(pair.a.least(), 1), number(pair.b.least(), 1),
                number(pair.ratio.median(), 3)});
    report->figure(name + " full_ms", pair.a.median());
    report->figure(name + " light_ms", pair.b.median());
    report->figure(name + " light/full", pair.ratio.median());
}

void ask(report *report)
{
    table table({"light only", "size", "full ms", "light ms", "least", "light's", "light/full"});
    std::string device = report->given().device();
    for (const std::string &path : bench_models(report->given()))
        measure(report, &table, path, device.c_str());
    table.print();
}

const question light("light", "a light-only change against a full frame", {"device"}, ask);

} // namespace
