/* test_areas SHEEN MODEL...: random cameras, lights, patterns and colours. Each pixel must show the
 * mean over its area, as 20 x 20 samples give it. Pixels within the surface and its lights are
 * judged separately for each pattern; pixels in which the surface or a light ends are measured
 * apart. */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/area_samples.h"
#include "tests/oracle/area_setups.h"
#include "tests/oracle/model.h"
#include "tests/oracle/render.h"
#include "tests/oracle/samples.h"
#include "tests/oracle/surface_grid.h"
#include "tests/oracle/verdict.h"

namespace
{

const int n_setups = 60, width_px = 48, height_px = 36;
/* With the first seed all pixels are judged; with the second, whose setups have images that change
 * within one pixel and lie over each other, only pixels within the surface and its lights. */
const uint32_t seeds[] = {20260, 4000};

/* Errors of the colours' bytes, in 1/255. */
const double max_mean = 1, max_p99 = 8;
const double max_border_mean = 3, max_border_p99 = 32;
/* Errors where the surface ends within a pixel: of the colours, and of the coverage (a share of the
 * pixel). */
const double max_edge_mean = 3, max_edge_p99 = 32, max_coverage_p99 = 0.1;
/* A pattern that changes faster than this between two samples, in its periods, is judged by its
 * mean only, because the samples scatter by a fortieth of the range between dark and bright. */
const double max_step = 0.25, max_fine_mean = 2;
/* pixels of each pattern: a percentile of fewer would mean nothing */
const size_t least_pixels = 2000;

const char *const pattern_names[] = {"stripes", "lattice",  "circles", "lines",
                                     "rainbow", "distance", "image"};
const size_t n_patterns = sizeof pattern_names / sizeof pattern_names[0];

struct worst_pixel {
    double error = 0;
    std::string where;
};

/* The errors of one kind of pixels. */
struct errors {
    std::vector<double> all;
    worst_pixel worst;

    void add(double error, const std::string &where)
    {
        all.push_back(error);
        if (!(error <= worst.error))
            worst = {error, where};
    }
};

struct found_errors {
    errors inside[n_patterns], fine, at_border, at_edge, coverage;
};

/* The largest difference of alpha and of the displayed colours laid over black, in 1/255. Laid over
 * black, because a colour that is nearly transparent is hardly visible. Both colours have straight
 * alpha. */
double difference(const rgba &a, const rgba &b)
{
    double worst = std::fabs(a.a - b.a);
    for (double part : {a.a * a.r - b.a * b.r, a.a * a.g - b.a * b.g, a.a * a.b - b.a * b.b})
        worst = std::fmax(worst, std::fabs(part));
    return 255 * worst;
}

/* The lowest bit of a set. */
size_t first_of(unsigned set)
{
    return (size_t)__builtin_ctz(set);
}

void compare(const area_setup &setup, const planes &planes, const std::vector<area_sample> &samples,
             const std::string &name, bool only_inside, found_errors *found)
{
    for (size_t i = 0; i < samples.size(); i++) {
        const area_sample &sample = samples[i];
        std::string where =
            name + " (" + std::to_string(i % width_px) + "," + std::to_string(i / width_px) + ")";
        double error = difference({planes.red[i], planes.green[i], planes.blue[i], planes.alpha[i]},
                                  to_displayed(sample.light));
        if (only_inside && (sample.at_edge || sample.partly))
            continue;
        if (sample.at_edge) {
            if (sample.coverage > 0)
                found->at_edge.add(error, where);
            if (sample.coverage > 0 && sample.coverage < 1)
                found->coverage.add(std::fabs((double)planes.coverage[i] - sample.coverage), where);
        } else if (sample.partly) {
            found->at_border.add(error, where);
        } else if (sample.step > max_step) {
            found->fine.add(error, where);
        } else if (sample.met) {
            auto pattern = (size_t)setup.lines.lights[first_of(sample.met)].pattern.kind;
            found->inside[pattern].add(error, where);
        }
    }
}

void report(const char *name, errors *errors)
{
    double p99 = quantile(errors->all, 0.99), p999 = quantile(errors->all, 0.999);
    std::printf("%-14s %7zu | %7.3f %7.2f %7.2f %7.2f  %s\n", name, errors->all.size(),
                mean_of(errors->all), p99, p999, errors->worst.error, errors->worst.where.c_str());
}

void judge(found_errors *found, verdict *verdict)
{
    std::printf("%-14s %7s | %7s %7s %7s %7s\n", "error in 1/255", "pixels", "mean", "p99", "p99.9",
                "most");
    for (size_t k = 0; k < n_patterns; k++) {
        errors &errors = found->inside[k];
        report(pattern_names[k], &errors);
        std::string what = std::string(pattern_names[k]) + ", inside: ";
        verdict->check(errors.all.size() >= least_pixels, what + "too few pixels to judge");
        verdict->at_most(mean_of(errors.all), max_mean, what + "mean error in 1/255");
        verdict->at_most(quantile(errors.all, 0.99), max_p99,
                         what + "99th percentile of the error in 1/255");
    }
    report("finer", &found->fine);
    verdict->at_most(mean_of(found->fine.all), max_fine_mean,
                     "patterns finer than samples tell: mean error in 1/255");
    report("light borders", &found->at_border);
    verdict->at_most(mean_of(found->at_border.all), max_border_mean,
                     "light borders: mean error in 1/255");
    verdict->at_most(quantile(found->at_border.all, 0.99), max_border_p99,
                     "light borders: 99th percentile of the error in 1/255");
    report("silhouettes", &found->at_edge);
    verdict->at_most(mean_of(found->at_edge.all), max_edge_mean,
                     "silhouettes: mean error in 1/255");
    verdict->at_most(quantile(found->at_edge.all, 0.99), max_edge_p99,
                     "silhouettes: 99th percentile of the error in 1/255");
    std::printf("%-14s %7s | shares\n", "", "");
    report("coverage", &found->coverage);
    verdict->at_most(quantile(found->coverage.all, 0.99), max_coverage_p99,
                     "coverage: 99th percentile of the error");
}

std::string printed(const std::vector<std::string> &words)
{
    std::string text;
    for (const std::string &word : words)
        text += (word.find_first_of("#:/") == std::string::npos ? word : "'" + word + "'") + " ";
    return text;
}

/* ONLY_SETUP=N in the environment runs that setup alone and prints the command that draws it. */
int only_setup()
{
    const char *number = std::getenv("ONLY_SETUP");
    return number ? std::atoi(number) : -1;
}

/* What all setups have in common. */
struct bench {
    std::string sheen;
    temporary_folder folder;
    std::shared_ptr<const line_image> image;
    verdict *judged;
    found_errors found;

    bench(const std::string &program, verdict *verdict) : sheen(program), judged(verdict)
    {
        chance chance(seeds[0]);
        image = make_image(&chance, folder.file("image.png"), false);
    }

    void compare_setup(grid_model *model, uint32_t seed, int number)
    {
        chance chance(seed + 1 + (uint32_t)number);
        area_setup setup = make_area_setup(&chance, number, model->box_min, model->box_max, image,
                                           width_px, height_px);
        std::string file = folder.file("frame.exr"),
                    name = std::to_string(seed) + " setup " + std::to_string(number);
        std::vector<std::string> command = {sheen, "render", model->path, "-q",
                                            "-o",  file,     "--aov",     "coverage"};
        std::vector<std::string> options = setup.options();
        command.insert(command.end(), options.begin(), options.end());
        if (only_setup() >= 0)
            std::printf("%s %s\n", model->path.c_str(), printed(options).c_str());
        program_result result = run_program(command, folder);
        if (judged->check(result.exit_code == 0, name + ": " + result.errors))
            compare(setup, read_planes(file, "coverage"),
                    sample_areas(model->sample(setup.camera, area_samples_side), setup), name,
                    seed != seeds[0], &found);
    }
};

void run(const std::string &sheen, const std::vector<std::string> &paths, verdict *verdict)
{
    bench bench(sheen, verdict);
    int n_models = (int)paths.size();
    for (int k = 0; k < n_models; k++) { /* one after the other, because each has a renderer */
        grid_model model(paths[(size_t)k]);
        for (uint32_t seed : seeds)
            for (int i = 0; i < n_setups; i++) /* so that every pattern is drawn on every model */
                if ((i + i / (int)n_patterns) % n_models == k &&
                    (only_setup() < 0 || only_setup() == i))
                    bench.compare_setup(&model, seed, i);
    }
    judge(&bench.found, verdict);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_areas SHEEN MODEL...\n");
        return 2;
    }
    verdict verdict;
    try {
        run(argv[1], list_models(std::vector<std::string>(argv + 2, argv + argc)), &verdict);
    } catch (const std::exception &failure) {
        verdict.check(false, failure.what());
    }
    return verdict.finish();
}
