#include "tests/oracle/samples.h"

#include <cmath>
#include <stdexcept>

#include <png.h>

#include "tests/oracle/render.h"
#include "tests/oracle/srgb.h"

static picture read_picture(const std::string &path)
{
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    picture picture;
    if (png_image_begin_read_from_file(&image, path.c_str())) {
        picture.width_px = (int)image.width;
        picture.height_px = (int)image.height;
        image.format = PNG_FORMAT_RGBA;
        std::vector<uint8_t> rgba(PNG_IMAGE_SIZE(image));
        if (png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr)) {
            for (size_t i = 0; i < rgba.size(); i += 4)
                picture.rgb.insert(picture.rgb.end(), &rgba[i], &rgba[i] + 3);
            return picture;
        }
    }
    throw std::runtime_error(path + ": " + image.message);
}

picture render_picture(const std::string &sheen, const std::string &model, int width_px,
                       int height_px, const std::vector<std::string> &options)
{
    temporary_folder folder;
    std::string file = folder.file("frame.png");
    std::string size = std::to_string(width_px) + "x" + std::to_string(height_px);
    std::vector<std::string> command = {sheen, "render", model, "-o", file, "-q", "--size", size};
    command.insert(command.end(), options.begin(), options.end());
    program_result result = run_program(command, folder);
    if (result.exit_code != 0)
        throw std::runtime_error(model + ": " + result.errors);
    return read_picture(file);
}

std::vector<double> averaged(const picture &large, int scale)
{
    int width = large.width_px / scale, height = large.height_px / scale;
    std::vector<double> mean((size_t)width * (size_t)height * 3, 0);
    for (int y = 0; y < height * scale; y++)
        for (int x = 0; x < width * scale; x++) {
            size_t from = ((size_t)y * (size_t)large.width_px + (size_t)x) * 3;
            size_t to = ((size_t)(y / scale) * (size_t)width + (size_t)(x / scale)) * 3;
            for (size_t k = 0; k < 3; k++)
                mean[to + k] += light_of(large.rgb[from + k] / 255.0);
        }
    for (double &value : mean)
        value = 255 * displayed_of(value / (scale * scale));
    return mean;
}

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
