/* bench_frame: how long an exact frame takes against Embree's, which ends in a tessellation for
 * what is seen and in its own approximate caps for normals.
 *
 * Same cage, camera, size, light and stripes, two threads each; runs in turn, the camera a little
 * on in every pair so that no planes are kept. Ours is visibility + evaluate + shade, filtered;
 * "all" has the picture read back, too. Embree: rtcIntersect8 and rtcInterpolate, one sample a
 * pixel. How alike the two pictures are is printed beside the times. */
#include "tests/bench/bench.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "tests/bench/embree.h"
#include "tests/oracle/scene.h"
#include "tests/oracle/model.h"

namespace
{

struct size {
    uint32_t width, height;
};

/* What both show of one view. */
struct likeness {
    size_t ours = 0, theirs = 0, both = 0; /* pixels covered */
    double mean_deg = 0, median_deg = 0;   /* between the normals of pixels that both cover */
};

vec3 normal_at(const float *normals, size_t i)
{
    return {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
}

likeness compare(drawing *ours, const embree_scene &theirs, frame_request request)
{
    request.planes |= PLANE_NORMAL;
    frame frame = ours->render(request);
    embree_picture picture;
    theirs.render(request, true, &picture);
    likeness like;
    samples degrees;
    size_t pixels = (size_t)frame.width_px * frame.height_px;
    for (size_t i = 0; i < pixels; i++) {
        vec3 a = normal_at((const float *)frame.plane[2], i), b = normal_at(&picture.normals[0], i);
        like.ours += finite(a);
        like.theirs += finite(b);
        if (!finite(a) || !finite(b))
            continue;
        like.both++;
        double deg = angle(a, b) * 180 / M_PI;
        like.mean_deg += deg;
        if (like.both % 101 == 0) /* a sample does for the median */
            degrees.add(deg);
    }
    like.mean_deg /= (double)like.both;
    like.median_deg = degrees.median();
    frame_finish(&frame);
    return like;
}

/* One size of one model, both warm. */
void measure_size(report *report, table *warm, table *alike, const std::string &name, size size,
                  const scene &scene, drawing *ours, const embree_scene &theirs)
{
    frame_request request = scene.request(size.width, size.height);
    auto view = [&](int run) {
        frame_request moved = request;
        orbit(&moved.camera, 0.1 * run);
        return moved;
    };
    embree_picture picture;
    samples all, visibility, evaluate, shade;
    pair_of_samples pair = measure_pairs(
        report->given().runs,
        [&](int run) {
            frame_times times;
            double ms = time_ms([&] { times = ours->times(view(run)); });
            if (run > 0) {
                all.add(ms);
                visibility.add((double)times.visibility_us / 1000);
                evaluate.add((double)times.evaluate_us / 1000);
                shade.add((double)times.shade_us / 1000);
            }
            return stages_ms(times);
        },
        [&](int run) { return time_ms([&] { theirs.render(view(run), false, &picture); }); });
    std::string of = std::to_string(size.width) + "x" + std::to_string(size.height);
    std::string key = name + " " + of + " ";
    warm->row({name, of, number(visibility.median(), 1), number(evaluate.median(), 1),
               number(shade.median(), 1), number(pair.a.median(), 1), number(all.median(), 1),
               number(pair.b.median(), 1), number(pair.a.least(), 1), number(pair.b.least(), 1),
               number(pair.ratio.median(), 2)});
    report->figure(key + "visibility_ms", visibility.median());
    report->figure(key + "evaluate_ms", evaluate.median());
    report->figure(key + "shade_ms", shade.median());
    report->figure(key + "frame_ms", pair.a.median());
    report->figure(key + "all_ms", all.median());
    report->figure(key + "embree_ms", pair.b.median());
    report->figure(key + "least_frame_ms", pair.a.least());
    report->figure(key + "least_embree_ms", pair.b.least());
    report->figure(key + "embree/frame ratio", pair.ratio.median());
    likeness like = compare(ours, theirs, request);
    alike->row({name, of, count((double)like.ours), count((double)like.theirs),
                count((double)like.both), number(like.mean_deg, 4), number(like.median_deg, 4)});
    report->figure(key + "covered pixels", (double)like.ours);
    report->figure(key + "embree covered pixels", (double)like.theirs);
    report->figure(key + "normals_apart_deg", like.mean_deg);
}

void measure_model(report *report, const std::string &path, const std::vector<size> &sizes,
                   const char *device, table *cold, table *warm, table *alike)
{
    std::shared_ptr<const cage> cage = read_cage_file(path);
    std::string name = model_name(path), lacks = embree_lacks(*cage);
    if (!lacks.empty())
        std::printf("%s: Embree draws it without%s\n", name.c_str(), lacks.c_str());
    std::unique_ptr<scene> scene;
    std::unique_ptr<drawing> ours;
    std::unique_ptr<embree_scene> theirs;
    embree_picture picture;
    double tables = time_ms([&] { scene.reset(new class scene(cage)); });
    double start = time_ms([&] { ours.reset(new drawing(*scene, device)); });
    frame_request request = scene->request(sizes[0].width, sizes[0].height);
    report->note(name + " device", ours->device());
    double first = time_ms([&] { ours->times(request); });
    double build = time_ms([&] { theirs.reset(new embree_scene(*cage, 4, bench_threads)); });
    double their_first = time_ms([&] { theirs->render(request, false, &picture); });
    cold->row({name, count((double)cage->n_faces), number(tables, 1), number(start, 1),
               number(first, 1), number(build, 1), number(their_first, 1)});
    report->figure(name + " tables_ms", tables);
    report->figure(name + " start_ms", start);
    report->figure(name + " first_frame_ms", first);
    report->figure(name + " embree_build_ms", build);
    report->figure(name + " embree_first_frame_ms", their_first);
    for (size size : sizes)
        measure_size(report, warm, alike, name, size, *scene, ours.get(), *theirs);
}

} // namespace

int main(int argc, char **argv)
{
    return bench_main("bench_frame", [&] {
        report report("bench_frame", argc, argv, {"device", "large"});
        std::vector<size> sizes = {{640, 480}, {1280, 720}, {1920, 1080}};
        if (report.given().other("large", "no") == "yes")
            sizes.push_back({3840, 2160});
        std::string device = report.given().other("device", "software");
        std::vector<std::string> models = bench_models(report.given());
        if (models.empty())
            throw std::runtime_error("no model is there");
        report.note("peer", embree_scene::version() + ", tessellation rate 4, " +
                                std::to_string(bench_threads) + " threads");
        table cold({"cold", "faces", "tables ms", "start ms", "first frame ms", "Embree build ms",
                    "Embree first ms"});
        table warm({"warm, medians", "size", "visibility", "evaluate", "shade", "frame ms",
                    "all ms", "Embree ms", "least", "Embree's", "ratio"});
        table alike({"same picture", "size", "covered", "Embree's", "both", "normals apart, deg",
                     "median"});
        for (const std::string &path : models)
            measure_model(&report, path, sizes, device.c_str(), &cold, &warm, &alike);
        cold.print();
        warm.print();
        alike.print();
        report.finish();
    });
}
