/* test_fine SHEEN MODEL...: patterns much finer than a pixel must show their mean colour without
 * any pattern. No row of the picture may have a spectral line above what rounding to eight bits
 * explains. The same rows without filtering show that the test would find one. */
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/oracle/frame_loop.h"
#include "tests/oracle/lines.h"
#include "tests/oracle/srgb.h"

namespace
{

const int width_px = 320, height_px = 240;
const double count = 100000, duty = 0.4;
const double max_mean_error = 1.0 / 255;
const double rounding = 0.5 / 255; /* of the eight bits of a pixel */
const double max_line = 0.5 / 255; /* amplitude */
const double min_unfiltered = 0.1; /* amplitude */
/* periods for each pixel, at least, in the direction across the pixel */
const double fine = 20;
const size_t run_px = 64;

struct figures {
    size_t n = 0, runs = 0;
    double sum = 0, line = 0;
    std::vector<double> off; /* of a pixel's difference from the expected mean */
};

/* The largest amplitude among the sinusoids of a run of pixels, after its mean is subtracted. */
double largest_line(const std::vector<double> &run)
{
    double n = (double)run.size(), mean = 0, largest = 0;
    for (double value : run)
        mean += value / n;
    for (size_t k = 1; 2 * k < run.size(); k++) {
        std::complex<double> sum = 0;
        for (size_t x = 0; x < run.size(); x++)
            sum += std::polar(run[x] - mean, -2 * M_PI * (double)k * (double)x / n);
        largest = std::max(largest, 2 * std::abs(sum) / n);
    }
    return largest;
}

/* Whether the pixel and all its neighbours are on the surface, so that it shows nothing else. */
bool is_surrounded(const planes &planes, int x, int y)
{
    for (int k = 0; k < 9; k++)
        if (!planes.hit((size_t)(y + k / 3 - 1) * (size_t)planes.width_px +
                        (size_t)(x + k % 3 - 1)))
            return false;
    return true;
}

/* Whether the pattern is much finer than the pixel there, and the pixel's neighbours see the light,
 * too. */
bool is_fine(const planes &planes, int x, int y)
{
    if (x < 1 || y < 1 || x + 1 >= planes.width_px || y + 1 >= planes.height_px)
        return false;
    for (int k = 0; k < 9; k++) {
        size_t i = (size_t)(y + k / 3 - 1) * (size_t)planes.width_px + (size_t)(x + k % 3 - 1);
        if (!planes.hit(i) || !(std::hypot(planes.dsdx[i], planes.dsdy[i]) * count > fine) ||
            !(std::hypot(planes.dtdx[i], planes.dtdy[i]) * count > fine))
            return false;
    }
    return true;
}

figures measure(const planes &planes, double mean)
{
    figures f;
    for (int y = 0; y < planes.height_px; y++) {
        std::vector<double> run;
        for (int x = 0; x <= planes.width_px; x++) {
            if (x < planes.width_px && is_fine(planes, x, y)) {
                double value = planes.green[(size_t)y * (size_t)planes.width_px + (size_t)x];
                f.n++;
                f.sum += value;
                f.off.push_back(std::fabs(value - mean));
                run.push_back(value);
                continue;
            }
            if (run.size() >= run_px) {
                f.runs++;
                f.line = std::fmax(f.line, largest_line(run));
            }
            run.clear();
        }
    }
    return f;
}

/* If the whole light is foreground or background, every pixel is. */
void judge_whole(const std::string &sheen, const model &model, const view &chosen, verdict *verdict)
{
    for (double whole : {0.0, 1.0})
        for (double periods : {40.0, count}) {
            line_setup setup;
            setup.family = line_family::zebra;
            setup.lights.resize(1);
            setup.lights[0].u = {1, 0, 0};
            setup.lights[0].v = {0, 1, 0};
            setup.lights[0].pattern.duty = whole;
            setup.lights[0].pattern.count = periods;
            view view = chosen;
            planes planes;
            int exit_code;
            std::string wrong = render_view(sheen, model.path, &view, "P,N,ptex,light,dlight",
                                            line_options(setup), &planes, &exit_code);
            if (!verdict->check(wrong.empty(), wrong))
                return;
            size_t off = 0;
            for (int y = 1; y + 1 < height_px; y++)
                for (int x = 1; x + 1 < width_px; x++)
                    off += is_surrounded(planes, x, y) &&
                           planes.green[(size_t)y * width_px + (size_t)x] != (float)whole;
            verdict->check(off == 0, model.name + " duty " + std::to_string(whole) + ": " +
                                         std::to_string(off) + " pixels of another colour");
        }
}

struct fine_pattern {
    const char *name;
    line_pattern_kind kind;
    double mean;
};

void judge(const std::string &sheen, const model &model, const view &chosen,
           const fine_pattern &fine_pattern, verdict *verdict)
{
    double radius = 0.5 * model.diagonal();
    line_light light;
    light.centre = model.middle() + vec3{0, 0, 2 * radius};
    light.u = (16 * radius) * normalized({1, 0.2, 0.1});
    light.v = (16 * radius) * normalized({-0.2, 1, 0.1});
    light.pattern.kind = fine_pattern.kind;
    light.pattern.count = count;
    light.pattern.duty = duty;
    light.pattern.rotation_deg = 20;
    line_setup setup;
    setup.lights = {light};
    std::string what = model.name + " " + chosen.name + " " + fine_pattern.name + ": ";
    for (const char *filter : {"exact", "off"}) {
        view view = chosen;
        std::vector<std::string> options = line_options(setup);
        options.insert(options.end(), {"--filter", filter});
        planes planes;
        int exit_code;
        std::string wrong = render_view(sheen, model.path, &view, "P,N,ptex,light,dlight", options,
                                        &planes, &exit_code);
        if (!verdict->check(wrong.empty(), wrong))
            return;
        double mean = displayed_of(fine_pattern.mean);
        figures f = measure(planes, mean);
        double mean_error = std::fabs(f.sum / (double)f.n - mean);
        double off = quantile(f.off, 0.999);
        std::printf("%-12s %-8s %-8s %-6s %6zu px %4zu runs | mean off %5.2f/255, p99.9 of a pixel "
                    "%6.2f/255 "
                    "| largest line %6.2f/255\n",
                    model.name.c_str(), view.name.c_str(), fine_pattern.name, filter, f.n, f.runs,
                    255 * mean_error, 255 * off, 255 * f.line);
        verdict->check(f.runs >= 20, what + "too few rows to judge");
        if (std::string(filter) == "off") {
            verdict->check(f.line > min_unfiltered, what + "no noise even without filtering");
            continue;
        }
        verdict->at_most(mean_error, max_mean_error, what + "mean colour");
        verdict->at_most(off, max_mean_error + rounding, what + "colour of a pixel p99.9");
        verdict->at_most(f.line, max_line, what + "line in a row's spectrum");
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_fine SHEEN MODEL...\n");
        return 2;
    }
    const fine_pattern patterns[] = {
        {"stripes", line_pattern_kind::stripes, duty},
        {"lattice", line_pattern_kind::lattice, 1 - (1 - duty) * (1 - duty)},
        {"circles", line_pattern_kind::circles, duty},
        {"rainbow", line_pattern_kind::rainbow, 0.5},
    };
    verdict verdict;
    for (const std::string &path : list_models(std::vector<std::string>(argv + 2, argv + argc))) {
        model model = read_model(path);
        double radius = 0.5 * model.diagonal();
        view view;
        view.name = "above";
        view.eye = model.middle() + (3.5 * radius) * normalized({0.3, -0.5, 0.9});
        view.target = model.middle();
        view.up = {0, 0, 1};
        view.fov_deg = 30;
        view.width_px = width_px;
        view.height_px = height_px;
        judge_whole(argv[1], model, view, &verdict);
        for (const fine_pattern &pattern : patterns)
            judge(argv[1], model, view, pattern, &verdict);
    }
    return verdict.finish();
}
