/* test_shares MODEL...: the coverage plane holds the share of each pixel that shows surface. It is
 * compared with 20 x 20 samples of each pixel: the centres of a frame enlarged by that factor,
 * which meet the surface or do not. */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/scene.h"
#include "tests/oracle/vec.h"
#include "tests/oracle/verdict.h"

namespace
{

const int side = 20, per_pixel = side * side;
const uint32_t width_px = 160, height_px = 120;
const uint32_t seed = 5;
const int n_views = 5; /* the default camera, and random ones */
/* Of each model's pixels that an edge crosses, at least this share is within most_off of the right
 * value. */
const double most_off = 0.1, least_good = 0.99;

/* White in front of transparent. */
frame_request request_for(const scene &scene, int view, std::mt19937 *random)
{
    frame_request request = scene.request(width_px, height_px);
    request.lines.family = LINES_ZEBRA;
    std::fill(request.lights[0].pattern.background, request.lights[0].pattern.background + 4, 1.f);
    if (view == 0)
        return request;
    std::normal_distribution<double> normal;
    vec3 away = normalized({normal(*random), normal(*random), normal(*random)});
    const double *low = scene.tables.box_min, *high = scene.tables.box_max;
    vec3 box = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    const double direction[3] = {away.x, away.y, away.z};
    for (int a = 0; a < 3; a++) {
        request.camera.target[a] = 0.5 * (low[a] + high[a]);
        request.camera.eye[a] = request.camera.target[a] + 1.6 * length(box) * direction[a];
    }
    if (view % 2 == 0) {
        request.camera.kind = CAMERA_ORTHOGRAPHIC;
        request.camera.ortho_height = 0.9 * length(box);
    }
    return request;
}

/* For each pixel, how many of its per_pixel samples meet the surface. */
std::vector<int> sampled(drawing *drawing, frame_request request)
{
    request.width_px *= (uint32_t)side;
    request.height_px *= (uint32_t)side;
    request.unfiltered = true;
    request.planes = PLANE_COLOUR;
    frame frame = drawing->render(request);
    auto *colour = static_cast<const uint8_t(*)[4]>(frame.plane[0]);
    std::vector<int> met((size_t)width_px * height_px);
    for (size_t y = 0, i = 0; y < request.height_px; y++)
        for (size_t x = 0; x < request.width_px; x++, i++)
            met[y / side * width_px + x / side] += colour[i][3] > 0;
    frame_finish(&frame);
    return met;
}

struct tally {
    size_t edges = 0, good = 0;
    double sum = 0;
};

tally compare(drawing *drawing, frame_request request, const std::string &name, verdict *verdict)
{
    std::vector<int> met = sampled(drawing, request);
    request.planes = PLANE_COLOUR | PLANE_NORMAL | PLANE_COVERAGE;
    frame frame = drawing->render(request);
    auto *share = static_cast<const float *>(frame.plane[7]);
    auto *normal = static_cast<const float(*)[3]>(frame.plane[2]);
    tally tally;
    size_t hit_without_share = 0;
    for (size_t i = 0; i < met.size(); i++) {
        hit_without_share += !std::isnan(normal[i][0]) && !(share[i] > 0);
        bool whole = met[i] == 0 || met[i] == per_pixel;
        if (whole && (double)share[i] == (double)met[i] / per_pixel)
            continue;
        double off = std::fabs((double)share[i] - (double)met[i] / per_pixel);
        tally.edges++;
        tally.good += off <= most_off;
        tally.sum += off;
    }
    frame_finish(&frame);
    verdict->check(hit_without_share == 0, name + ": a pixel whose centre hits has no coverage");
    verdict->check(tally.edges > 100, name + ": there are no edges");
    return tally;
}

/* A model's views do not depend on which models were judged before it. */
void judge(const std::string &path, verdict *verdict)
{
    std::mt19937 random(seed);
    scene scene(read_cage_file(path));
    drawing drawing(scene);
    tally all;
    std::string name = path.substr(path.rfind('/') + 1);
    for (int view = 0; view < n_views; view++) {
        frame_request request = request_for(scene, view, &random);
        tally one = compare(&drawing, request, name + ", view " + std::to_string(view), verdict);
        all.edges += one.edges;
        all.good += one.good;
        all.sum += one.sum;
    }
    double bad = 1 - (double)all.good / (double)all.edges;
    verdict->at_most(bad, 1 - least_good, name + ", share of the pixels at edges that are off");
    std::printf("%-28s %6zu px at edges, mean off %.4f, %.2f %% within %.1f\n", name.c_str(),
                all.edges, all.sum / (double)all.edges, 100 * (double)all.good / (double)all.edges,
                most_off);
}

} // namespace

int main(int argc, char **argv)
{
    verdict verdict;
    for (int i = 1; i < argc; i++)
        try {
            judge(argv[i], &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
    return verdict.finish();
}
