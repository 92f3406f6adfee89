/* test_filter SHEEN [MODEL.obj]...: the colour of a pixel is the mean over the pixel. Each frame is
 * held against the same view one sample a pixel (--filter off) and many times larger, whose squares
 * of pixels are averaged. */
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/samples.h"
#include "tests/oracle/verdict.h"

namespace
{

const int samples = 16; /* a pixel, each way */
/* Over all pixels of a frame, in 1/255. */
const double max_mean = 1, max_p99 = 8;
/* The car is the exception: at 640 x 480 many of its parts are narrower than two pixels, and what
 * no pixel's centre sees cannot be known from the pixels around. */
const double max_p99_car = 11;
/* Over the pixels that an outline runs through, as measured: of 16 rays one more or less is 16/255,
 * and corners of borders, of which only the nearest side is known, cost more. */
const double max_outline_mean = 20, min_outline_mean_off = 40;

bool is_car(const std::string &model)
{
    return model.find("catmark_car") != std::string::npos;
}

struct scene {
    std::string sheen, model;
    int width_px, height_px;
    std::vector<std::string> options;
};

picture render(const scene &scene, int scale, bool filtered)
{
    std::vector<std::string> options = scene.options;
    options.insert(options.end(), {"--filter", filtered ? "exact" : "off"});
    return render_picture(scene.sheen, scene.model, scene.width_px * scale, scene.height_px * scale,
                          options);
}

/* Stripes, with everything else there is: folds, creases, borders, the light's own border. */
void judge_stripes(scene scene, int count, verdict *verdict)
{
    scene.options = {"--pattern", "stripes:count=" + std::to_string(count)};
    std::vector<double> truth = averaged(render(scene, samples, false), samples);
    std::vector<double> error = differences(render(scene, 1, true), truth);
    std::vector<double> error_off = differences(render(scene, 1, false), truth);
    double mean = mean_of(error), off = mean_of(error_off);
    double p99 = quantile(error, 0.99), p99_off = quantile(error_off, 0.99);
    std::printf("%-36s %4d | %7.3f %6.1f | %7.3f %6.1f\n", scene.model.c_str(), count, mean, p99,
                off, p99_off);
    std::string what = scene.model + ", " + std::to_string(count) + " stripes, ";
    verdict->at_most(mean, max_mean, what + "mean error in 1/255");
    verdict->at_most(p99, is_car(scene.model) ? max_p99_car : max_p99,
                     what + "99th percentile of the error in 1/255");
    verdict->check(p99_off > max_p99, what + "one sample a pixel would do as well");
}

/* A white surface before black: the share of the pixel that it covers, and nothing else. */
void judge_outline(scene scene, verdict *verdict)
{
    scene.options = {"--pattern", "stripes:fg=#ffffff,bg=#ffffff", "--miss", "#ffffff", "--empty",
                     "#000000"};
    std::vector<double> truth = averaged(render(scene, samples, false), samples);
    std::vector<double> error = differences(render(scene, 1, true), truth), outline;
    std::vector<double> error_off = differences(render(scene, 1, false), truth), outline_off;
    for (size_t i = 0; i < error.size(); i++)
        if (truth[3 * i] > 0 && truth[3 * i] < 255) {
            outline.push_back(error[i]);
            outline_off.push_back(error_off[i]);
        }
    double mean = mean_of(outline), off = mean_of(outline_off);
    std::printf("%-36s  %zu px of outline: mean error %.2f, one sample a pixel %.2f\n",
                scene.model.c_str(), outline.size(), mean, off);
    verdict->check(outline.size() > 100, scene.model + ": no outline");
    verdict->at_most(mean, max_outline_mean, scene.model + ", outline, mean error in 1/255");
    verdict->check(off > min_outline_mean_off, scene.model + ": the outline tells nothing");
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_filter SHEEN MODEL.obj...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-36s %4s | %7s %6s | %7s %6s\n", "error in 1/255", "", "mean", "p99", "off",
                "p99");
    for (int i = 2; i < argc; i++) {
        scene scene = {argv[1], argv[i], 640, 480, {}};
        try {
            judge_outline(scene, &verdict);
            for (int count : {20, 100, 400})
                judge_stripes(scene, count, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
    }
    return verdict.finish();
}
