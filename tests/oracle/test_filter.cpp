/* test_filter SHEEN MODEL.obj...: the colour of a pixel is the mean over the pixel. Frames are
 * compared with 16 x 16 samples for each pixel; frames of one sample for each pixel (--filter off)
 * are printed beside them. */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/light_samples.h"
#include "tests/oracle/model.h"
#include "tests/oracle/samples.h"
#include "tests/oracle/scene.h"
#include "tests/oracle/srgb.h"
#include "tests/oracle/verdict.h"
#include "tests/oracle/view.h"

namespace
{

/* The mean error over all pixels of a frame, in 1/255. */
const double max_mean = 1, max_p99 = 8;
/* The mean error over the pixels that an outline crosses. 1.1 to 3.3 were measured, and 5.5 for the
 * car: it has parts that no pixel's centre sees, and corners of borders, of which only the nearest
 * side is known. */
const double max_outline_mean = 7, min_outline_mean_off = 40;
/* A pixel from which no ray escapes is white, except for rounding in the sRGB curve. */
const double almost_white = 254.9;

const uint8_t miss[3] = {0x29, 0x30, 0x3b}, empty[3] = {0x80, 0x80, 0x80};
const std::vector<std::string> colour_options = {"--miss", "#29303b", "--empty", "#808080"};
/* Frames that are cut differently differ by rounding. Where a border passes so near to one of a
 * pixel's 16 rays that rounding decides, they differ by that ray's share. */
const double max_ray_apart = 16, max_rays_apart = 12;
/* number of stripes; the program itself draws them, too, and must give the same except for
 * rounding */
const int compared_count = 100;

void fill(float colour[4], const uint8_t rgb[3])
{
    for (int k = 0; k < 3; k++)
        colour[k] = (float)rgb[k] / 255;
    colour[3] = 1;
}

picture draw(drawing *drawing, frame_request request, bool filtered)
{
    request.unfiltered = !filtered;
    frame frame = drawing->render(request);
    auto *rgba = static_cast<const uint8_t(*)[4]>(frame.plane[0]);
    picture picture;
    picture.width_px = (int)frame.width_px;
    picture.height_px = (int)frame.height_px;
    for (size_t i = 0; i < (size_t)frame.width_px * frame.height_px; i++)
        picture.rgb.insert(picture.rgb.end(), rgba[i], rgba[i] + 3);
    frame_finish(&frame);
    return picture;
}

/* One model at one size. */
struct view_judge {
    std::string sheen, model, name;
    scene *shown;
    drawing *device;
    verdict *found;
    int width_px, height_px;

    frame_request request() const
    {
        frame_request request = shown->request((uint32_t)width_px, (uint32_t)height_px);
        fill(request.miss, miss);
        fill(request.empty, empty);
        return request;
    }

    /* A white surface in front of black. */
    frame_request outline_request() const
    {
        frame_request all = request();
        const uint8_t white[3] = {255, 255, 255}, black[3] = {0, 0, 0};
        fill(all.miss, white);
        fill(all.empty, black);
        fill(all.lights[0].pattern.background, white);
        return all;
    }

    /* The smallest rectangle that contains all pixels that are not black, and one pixel around
     * it. */
    middle_part part_of(const picture &outline) const
    {
        int half_width = 0, half_height = 0;
        for (int y = 0; y < height_px; y++)
            for (int x = 0; x < width_px; x++)
                if (outline.rgb[3 * ((size_t)y * (size_t)width_px + (size_t)x)] > 0) {
                    int right = std::max(x + 1 - width_px / 2, width_px / 2 - x);
                    int down = std::max(y + 1 - height_px / 2, height_px / 2 - y);
                    half_width = std::max(half_width, right);
                    half_height = std::max(half_height, down);
                }
        half_width = std::min(half_width + 1, width_px / 2);
        half_height = std::min(half_height + 1, height_px / 2);
        return {width_px / 2 - half_width, height_px / 2 - half_height, 2 * half_width,
                2 * half_height};
    }

    /* A frame of the samples, with the colour `outside` where there are none. */
    template <typename colour_of>
    std::vector<double> truth(const middle_part &part, const uint8_t outside[3],
                              colour_of colour) const
    {
        std::vector<double> rgb;
        for (int i = 0; i < width_px * height_px; i++) {
            int x = i % width_px - part.x0_px, y = i / width_px - part.y0_px;
            bool inside = x >= 0 && x < part.width_px && y >= 0 && y < part.height_px;
            for (int k = 0; k < 3; k++)
                rgb.push_back(inside ? colour((size_t)(y * part.width_px + x), k) : outside[k]);
        }
        return rgb;
    }

    void judge_outline(const light_samples &samples, const middle_part &part,
                       const picture &filtered) const
    {
        const uint8_t black[3] = {0, 0, 0};
        std::vector<double> truth = this->truth(part, black, [&](size_t i, int) {
            return 255 * displayed_of(1 - 1.0 * samples.n_empty[i] / light_samples::per_pixel);
        });
        std::vector<double> error = differences(filtered, truth), outline, outline_off;
        std::vector<double> error_off = differences(draw(device, outline_request(), false), truth);
        for (size_t i = 0; i < error.size(); i++)
            if (truth[3 * i] > 0 && truth[3 * i] < almost_white) {
                outline.push_back(error[i]);
                outline_off.push_back(error_off[i]);
            }
        double mean = mean_of(outline), off = mean_of(outline_off);
        std::printf("%-34s  %zu px of outline: mean error %.2f, one sample a pixel %.2f\n",
                    name.c_str(), outline.size(), mean, off);
        found->check(outline.size() > 100, name + ": no outline");
        found->at_most(mean, max_outline_mean, name + ", outline, mean error in 1/255");
        found->check(off > min_outline_mean_off, name + ": the outline tells nothing");
    }

    /* Stripes with everything that may occur: folds, creases, borders, and the border of the
     * light. */
    void judge_stripes(const light_samples &samples, const middle_part &part, int count) const
    {
        std::vector<uint16_t> bright = samples.bright(count);
        std::vector<double> truth = this->truth(part, empty, [&](size_t i, int k) {
            double light = bright[i] + light_of(miss[k] / 255.0) * samples.n_miss[i] +
                           light_of(empty[k] / 255.0) * samples.n_empty[i];
            return 255 * displayed_of(light / light_samples::per_pixel);
        });
        frame_request stripes = request();
        stripes.lights[0].pattern.count = count;
        picture filtered = draw(device, stripes, true);
        std::vector<double> error = differences(filtered, truth);
        std::vector<double> error_off = differences(draw(device, stripes, false), truth);
        double mean = mean_of(error), off = mean_of(error_off);
        double p99 = quantile(error, 0.99), p99_off = quantile(error_off, 0.99);
        std::printf("%-34s %4d | %7.3f %6.1f | %7.3f %6.1f\n", name.c_str(), count, mean, p99, off,
                    p99_off);
        std::fflush(stdout);
        std::string what = name + ", " + std::to_string(count) + " stripes, ";
        found->at_most(mean, max_mean, what + "mean error in 1/255");
        found->at_most(p99, max_p99, what + "99th percentile of the error in 1/255");
        found->check(p99_off > max_p99, what + "one sample a pixel would do as well");
        if (count != compared_count)
            return;
        std::vector<std::string> options = colour_options;
        auto text = [](const double v[3]) { return comma_separated({v[0], v[1], v[2]}); };
        const light &light = stripes.lights[0];
        options.insert(options.end(),
                       {"--pattern", "stripes:count=" + std::to_string(count), "--light-center",
                        text(light.centre), "--light-u", text(light.u), "--light-v", text(light.v),
                        "--eye", text(stripes.camera.eye), "--target", text(stripes.camera.target),
                        "--up", text(stripes.camera.up)});
        picture drawn = render_picture(sheen, model, width_px, height_px, options);
        std::vector<double> apart =
            differences(drawn, std::vector<double>(filtered.rgb.begin(), filtered.rgb.end()));
        auto off_by_more =
            std::count_if(apart.begin(), apart.end(), [](double d) { return d > 1; });
        found->at_most(quantile(apart, 1), max_ray_apart,
                       what + "sheen render draws another picture, by as many 1/255");
        found->at_most((double)off_by_more, max_rays_apart,
                       what + "channels that sheen render draws otherwise than rounding explains");
    }

    void judge() const
    {
        picture outline = draw(device, outline_request(), true);
        middle_part part = part_of(outline);
        light_samples samples(device, request(), part);
        bool cut = false;
        for (int i = 0; i < part.width_px * part.height_px; i++) {
            int x = i % part.width_px, y = i / part.width_px;
            bool rim = x == 0 || y == 0 || x == part.width_px - 1 || y == part.height_px - 1;
            cut |= rim && samples.n_empty[(size_t)i] < light_samples::per_pixel;
        }
        found->check(!cut, name + ": the model reaches further than what is sampled");
        judge_outline(samples, part, outline);
        for (int count : {20, compared_count, 400})
            judge_stripes(samples, part, count);
    }
};

void judge_model(const std::string &sheen, const std::string &path, verdict *verdict)
{
    bool is_car = path.find("catmark_car") != std::string::npos;
    scene scene(read_cage_file(path));
    drawing drawing(scene);
    struct size {
        int width_px, height_px;
    };
    std::vector<size> sizes = {{640, 480}};
    if (is_car)
        sizes.insert(sizes.end(), {{1280, 720}, {1440, 810}});
    for (const size &size : sizes) {
        std::string name = path.substr(path.rfind('/') + 1) + " " + std::to_string(size.width_px) +
                           "x" + std::to_string(size.height_px);
        view_judge{sheen, path, name, &scene, &drawing, verdict, size.width_px, size.height_px}
            .judge();
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_filter SHEEN MODEL.obj...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-34s %4s | %7s %6s | %7s %6s\n", "error in 1/255", "", "mean", "p99", "off",
                "p99");
    for (int i = 2; i < argc; i++)
        try {
            judge_model(argv[1], argv[i], &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
    return verdict.finish();
}
