/* bench_frame: how long an exact frame takes, compared with peers that tessellate the surface and
 * approximate normals near extraordinary vertices: Embree without a GPU, OpenSubdiv's drawing on a
 * GPU. All have the same cage, camera, size, light and stripes, and two threads. They run
 * alternately, and the camera moves a little in every round, so that no planes are reused. Ours is
 * visibility + evaluate + shade, filtered; "wall" is the elapsed time of the same from the request
 * on; "all" includes reading the picture back. "off" is ours without antialiasing, that is, with
 * one sample of the surface for each pixel like the peers, but with filtered lines. OpenSubdiv draws in
 * our GL context and is left out where our device has none (native). The light is a rectangle above the model
 * with 40 stripes. How similar the pictures are is printed beside the times. */
#include "tests/bench/peers.h"
#include "tests/bench/question.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "tests/bench/timing.h"
#include "tests/oracle/cage_file.h"
#include "tests/oracle/vec.h"

namespace
{

struct size {
    uint32_t width, height;
};

/* How similar two pictures of one view are. */
struct likeness {
    size_t ours = 0, theirs = 0, both = 0; /* pixels that each covers */
    double mean_deg = 0, median_deg = 0;   /* angle between the normals of pixels that both cover */
};

/* One model, and all that draw it. */
struct contest {
    std::string name;
    std::unique_ptr<scene> its_scene;
    std::unique_ptr<drawing> ours;
    std::vector<frame_peer_kind> kinds;
    std::vector<std::unique_ptr<frame_peer>> peers;
};

/* The view that all draw. It is the default view, except for OpenSubdiv's car, which is seen as in
 * earlier measurements: close by the front wheel, with a field of view of 30 degrees. */
frame_request request_of(const contest &contest, size size)
{
    frame_request request = contest.its_scene->request(size.width, size.height);
    if (contest.name == "catmark_car") {
        const double eye[3] = {4.5, -4.5, 2.2}, target[3] = {0.6, -1.9, 0.25}, up[3] = {0, 0, 1};
        std::copy(eye, eye + 3, request.camera.eye);
        std::copy(target, target + 3, request.camera.target);
        std::copy(up, up + 3, request.camera.up);
        request.camera.fov_deg = 30;
    }
    return request;
}

struct tables {
    table cold, warm, alike;
};

std::string text(size size)
{
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

vec3 normal_at(const float *normals, size_t i)
{
    return {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
}

likeness compare(const float *ours, const float *theirs, size_t pixels)
{
    likeness like;
    samples degrees;
    for (size_t i = 0; i < pixels; i++) {
        vec3 a = normal_at(ours, i), b = normal_at(theirs, i);
        like.ours += finite(a);
        like.theirs += finite(b);
        if (!finite(a) || !finite(b))
            continue;
        like.both++;
        double deg = angle(a, b) * 180 / M_PI;
        like.mean_deg += deg;
        if (like.both % 101 == 1) /* a sample of the pixels is enough for the median */
            degrees.add(deg);
    }
    if (like.both) {
        like.mean_deg /= (double)like.both;
        like.median_deg = degrees.median();
    }
    return like;
}

/* Prints how similar the pictures are. */
void compare_all(report *report, table *alike, const contest &contest, size size)
{
    frame_request request = request_of(contest, size);
    request.planes |= PLANE_NORMAL;
    frame frame = contest.ours->render(request);
    const float *normals = (const float *)frame.plane[2];
    std::string key = contest.name + " " + text(size) + " ";
    report->figure(key + "covered pixels", (double)covered_pixels(frame));
    if (contest.peers.empty())
        alike->row({contest.name, text(size), count((double)covered_pixels(frame))});
    for (size_t i = 0; i < contest.peers.size(); i++) {
        std::vector<float> theirs = contest.peers[i]->normals(request);
        likeness like = compare(normals, theirs.data(), (size_t)size.width * size.height);
        const std::string &peer = contest.kinds[i].name;
        if (std::abs((double)like.theirs / (double)like.ours - 1) > 0.01)
            throw std::runtime_error(peer + " draws another picture of " + contest.name + ": " +
                                     count((double)like.theirs) + " pixels covered, not " +
                                     count((double)like.ours));
        alike->row({contest.name, text(size), count((double)like.ours), peer,
                    count((double)like.theirs), count((double)like.both), number(like.mean_deg, 4),
                    number(like.median_deg, 4)});
        report->figure(key + peer + " covered pixels", (double)like.theirs);
        report->figure(key + peer + " normals_apart_deg", like.mean_deg);
    }
    frame_finish(&frame);
}

/* A peer beside our frames with antialiasing, to which its ratio is, and without. */
void add_peer(report *report, std::vector<std::string> *row, const std::string &key,
              const std::string &peer, const turn &theirs, const turn &aliased)
{
    double to_aliased = theirs.ms.median() / aliased.ms.median();
    row->insert(row->end(), {number(theirs.ms.median(), 2), number(theirs.ms.least(), 2),
                             number(theirs.ratio.median(), 2), number(to_aliased, 2)});
    report->figure(key + peer + "_ms", theirs.ms.median());
    report->figure(key + "least_" + peer + "_ms", theirs.ms.least());
    report->figure(key + peer + "/frame ratio", theirs.ratio.median());
    report->figure(key + peer + "/aliased ratio", to_aliased);
}

/* Measures one model at one size, after a first frame. */
void measure_size(report *report, tables *tables, const contest &contest, size size)
{
    frame_request request = request_of(contest, size);
    auto view = [&](double run) {
        frame_request moved = request;
        orbit(&moved.camera, 0.1 * run);
        return moved;
    };
    samples visibility, evaluate, shade, wall, all;
    std::vector<timed_call> calls = {[&](int run) {
        frame_cost cost = contest.ours->cost(view(run));
        if (run > 0) {
            visibility.add((double)cost.stages.visibility_us / 1000);
            evaluate.add((double)cost.stages.evaluate_us / 1000);
            shade.add((double)cost.stages.shade_us / 1000);
            wall.add(cost.wall_ms);
            all.add(cost.all_ms);
        }
        return cost.stages_ms();
    }};
    calls.push_back([&](int run) {
        /* another view, since the planes kept of the same view would serve it */
        frame_request aliased = view(run + 0.5);
        aliased.aliased = true;
        return contest.ours->cost(aliased).stages_ms();
    });
    for (const auto &peer : contest.peers)
        calls.push_back([&](int run) { return peer->draw_ms(view(run)); });
    std::vector<turn> turns = measure_in_turn(report->given().runs, calls);

    std::string key = contest.name + " " + text(size) + " ";
    std::vector<std::string> row = {contest.name,
                                    text(size),
                                    number(visibility.median(), 2),
                                    number(evaluate.median(), 2),
                                    number(shade.median(), 2),
                                    number(turns[0].ms.median(), 2),
                                    number(turns[0].ms.least(), 2),
                                    number(wall.median(), 2),
                                    number(all.median(), 2),
                                    number(turns[1].ms.median(), 2),
                                    number(turns[1].ms.least(), 2)};
    report->figure(key + "visibility_ms", visibility.median());
    report->figure(key + "evaluate_ms", evaluate.median());
    report->figure(key + "shade_ms", shade.median());
    report->figure(key + "frame_ms", turns[0].ms.median());
    report->figure(key + "least_frame_ms", turns[0].ms.least());
    report->figure(key + "wall_ms", wall.median());
    report->figure(key + "all_ms", all.median());
    report->figure(key + "aliased_ms", turns[1].ms.median());
    report->figure(key + "least_aliased_ms", turns[1].ms.least());
    for (size_t i = 0; i < contest.peers.size(); i++)
        add_peer(report, &row, key, contest.kinds[i].name, turns[i + 2], turns[1]);
    tables->warm.row(row);
    compare_all(report, &tables->alike, contest, size);
}

/* Tables, the device and our first picture from the cage. */
std::vector<std::string> start_ours(report *report, contest *contest,
                                    const std::shared_ptr<const cage> &cage, size size)
{
    std::string device = report->given().device();
    double tables = time_ms([&] { contest->its_scene.reset(new scene(cage)); });
    double start =
        time_ms([&] { contest->ours.reset(new drawing(*contest->its_scene, device.c_str())); });
    frame_request request = request_of(*contest, size);
    double first = time_ms([&] { contest->ours->cost(request); });
    report->figure(contest->name + " tables_ms", tables);
    report->figure(contest->name + " start_ms", start);
    report->figure(contest->name + " first_frame_ms", first);
    note_device(report, contest->ours->info());
    return {contest->name, count((double)cage->n_faces), number(tables, 1), number(start, 1),
            number(first, 1)};
}

/* The same by every peer; adds to the row. */
void start_peers(report *report, contest *contest, const cage &cage, size size,
                 std::vector<std::string> *row)
{
    frame_request request = request_of(*contest, size);
    for (const frame_peer_kind &kind : contest->kinds) {
        report->note(kind.name, kind.about);
        std::string lacks = kind.lacks(cage);
        if (!lacks.empty())
            std::printf("%s: %s draws it without%s\n", contest->name.c_str(), kind.name.c_str(),
                        lacks.c_str());
        double build = time_ms([&] { contest->peers.push_back(kind.build(cage, *contest->ours)); });
        double their_first = time_ms([&] { contest->peers.back()->draw_ms(request); });
        row->insert(row->end(), {number(build, 1), number(their_first, 1)});
        report->figure(contest->name + " " + kind.name + "_build_ms", build);
        report->figure(contest->name + " " + kind.name + "_first_frame_ms", their_first);
    }
}

tables make_tables(const std::vector<frame_peer_kind> &kinds)
{
    std::vector<std::string> cold = {"cold", "faces", "tables ms", "start ms", "first frame ms"};
    std::vector<std::string> warm = {"warm, medians", "size",     "visibility", "evaluate",
                                     "shade",         "frame ms", "least",      "wall ms",
                                     "all ms",        "off ms",   "least"};
    std::vector<std::string> alike = {"same picture", "size", "covered"};
    for (const frame_peer_kind &kind : kinds) {
        cold.insert(cold.end(), {kind.name + " build ms", "first ms"});
        warm.insert(warm.end(), {kind.name + " ms", "least", "ratio", "ratio off"});
    }
    if (!kinds.empty())
        alike.insert(alike.end(), {"peer", "peer's", "both", "normals apart, deg", "median"});
    return {table(cold), table(warm), table(alike)};
}

void ask(report *report)
{
    std::unique_ptr<tables> tables;
    for (const std::string &path : bench_models(report->given())) {
        contest contest;
        contest.name = model_name(path);
        std::vector<size> sizes = {{640, 480}, {1280, 720}, {1920, 1080}};
        std::shared_ptr<const cage> cage = read_cage_file(path);
        std::vector<std::string> cold = start_ours(report, &contest, cage, sizes[0]);
        const struct renderer_info &device = contest.ours->info();
        /* Known once the device is open: auto and software choose it. */
        contest.kinds = frame_peers(device.n_threads == 0);
        if (!tables)
            tables.reset(new struct tables(make_tables(contest.kinds)));
        start_peers(report, &contest, *cage, sizes[0], &cold);
        tables->cold.row(cold);
        if (report->given().other("large", device.software ? "no" : "yes") == "yes")
            sizes.push_back({3840, 2160});
        for (size size : sizes)
            measure_size(report, tables.get(), contest, size);
    }
    tables->cold.print();
    tables->warm.print();
    tables->alike.print();
}

const question frame_question("frame",
                              "a frame of each model, cold and warm; --large yes or no: 3840x2160, "
                              "too (on hardware yes)",
                              {"device", "large"}, ask);

} // namespace
