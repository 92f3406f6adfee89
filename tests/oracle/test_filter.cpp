/* test_filter SHEEN [MODEL.obj]...: the colour of a pixel is the mean over the pixel. Each frame is
 * held against the same view one sample a pixel (--filter off) and many times larger, whose squares
 * of pixels are averaged. */
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "tests/oracle/render.h"
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

struct picture {
    int width_px = 0, height_px = 0;
    std::vector<uint8_t> rgb;
};

picture read_picture(const std::string &path)
{
    auto input = OIIO::ImageInput::open(path);
    if (!input)
        throw std::runtime_error(path + ": " + OIIO::geterror());
    const OIIO::ImageSpec &spec = input->spec();
    picture picture;
    picture.width_px = spec.width;
    picture.height_px = spec.height;
    picture.rgb.resize((size_t)spec.image_pixels() * 3);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, picture.rgb.data()))
        throw std::runtime_error(path + ": " + input->geterror());
    return picture;
}

struct scene {
    std::string sheen, model;
    int width_px, height_px;
    std::vector<std::string> options;
};

picture render(const scene &scene, int scale, bool filtered)
{
    temporary_folder folder;
    std::string file = folder.file("frame.tif");
    std::vector<std::string> command = {
        scene.sheen,
        "render",
        scene.model,
        "-o",
        file,
        "-q",
        "--size",
        std::to_string(scene.width_px * scale) + "x" + std::to_string(scene.height_px * scale),
        "--filter",
        filtered ? "exact" : "off"};
    command.insert(command.end(), scene.options.begin(), scene.options.end());
    program_result result = run_program(command, folder);
    if (result.exit_code != 0)
        throw std::runtime_error(scene.model + ": " + result.errors);
    return read_picture(file);
}

/* Each value's mean over scale x scale pixels of the large picture. */
std::vector<double> averaged(const picture &large, int scale)
{
    int width = large.width_px / scale, height = large.height_px / scale;
    std::vector<double> mean((size_t)width * (size_t)height * 3, 0);
    for (int y = 0; y < height * scale; y++)
        for (int x = 0; x < width * scale; x++) {
            size_t from = ((size_t)y * (size_t)large.width_px + (size_t)x) * 3;
            size_t to = ((size_t)(y / scale) * (size_t)width + (size_t)(x / scale)) * 3;
            for (size_t k = 0; k < 3; k++)
                mean[to + k] += large.rgb[from + k];
        }
    for (double &value : mean)
        value /= scale * scale;
    return mean;
}

/* The largest difference of a channel, of every pixel. */
std::vector<double> differences(const picture &picture, const std::vector<double> &truth)
{
    if (picture.rgb.size() != truth.size())
        throw std::runtime_error("the picture has another size than asked for");
    std::vector<double> worst(truth.size() / 3, 0);
    for (size_t i = 0; i < truth.size(); i++)
        worst[i / 3] = std::fmax(worst[i / 3], std::fabs(picture.rgb[i] - truth[i]));
    return worst;
}

double mean_of(const std::vector<double> &values)
{
    double sum = 0;
    for (double value : values)
        sum += value;
    return values.empty() ? NAN : sum / (double)values.size();
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
