/* bench_worker [--workers FOLDER]: the cost of a separate process for a job. Pictures of 1920x1080
 * are written alternately in this process and by sheend-image. Then the smallest job of each
 * worker: a cage of one face, and an image of one pixel. */
#include "tests/bench/question.h"

#include <cstdlib>
#include <stdexcept>
#include <vector>

extern "C" {
#include "server/base/block_cache.h"
#include "server/threads/workers.h"
}

namespace
{

constexpr uint32_t WIDTH = 1920, HEIGHT = 1080;

void check(bool ok, const error &error)
{
    if (!ok)
        throw std::runtime_error(error.text);
}

/* Stripes one pixel wide and wider, as in a frame's colour plane. */
std::vector<uint8_t> stripes()
{
    std::vector<uint8_t> rgba(size_t{4} * WIDTH * HEIGHT, 255);
    for (size_t y = 0; y < HEIGHT; y++)
        for (size_t x = 0; x < WIDTH; x++)
            for (size_t k = 0; k < 3; k++)
                rgba[4 * (y * WIDTH + x) + k] = (x * x + y * y) / 20000 % 2 ? 255 : 0;
    return rgba;
}

picture picture_of(const std::vector<uint8_t> &rgba, image_format format)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    picture picture = {};
    picture.format = format;
    picture.width_px = WIDTH;
    picture.height_px = HEIGHT;
    picture.n_channels = 4;
    for (size_t i = 0; i < 4; i++)
        picture.channels[i] = {names[i], IMAGE_UINT8, rgba.data() + i, 4, size_t{4} * WIDTH};
    return picture;
}

void measure_pictures(report *report, workers *workers)
{
    static const struct {
        const char *name;
        image_format format;
    } formats[] = {{"EXR", IMAGE_EXR}, {"TIFF", IMAGE_TIFF}};
    table table({"a picture", "here ms", "by a worker ms", "least here", "least", "worker/here"});
    const std::vector<uint8_t> rgba = stripes();
    const picture_block block = {rgba.data(), rgba.size()};
    for (const auto &f : formats) {
        const picture picture = picture_of(rgba, f.format);
        error error = {};
        uint8_t *bytes;
        size_t size;
        pair_of_samples pair = measure_pairs(
            report->given().runs,
            [&](int) {
                return time_ms([&] {
                    check(image_encode(picture.format, WIDTH, HEIGHT, picture.channels, 4, nullptr,
                                       0, &bytes, &size, &error),
                          error);
                    free(bytes);
                });
            },
            [&](int) {
                return time_ms([&] {
                    check(workers_write_image(workers, &picture, &block, 1, nullptr, &bytes, &size,
                                              &error),
                          error);
                    block_cache_give(nullptr, bytes);
                });
            });
        table.row({f.name, number(pair.a.median(), 1), number(pair.b.median(), 1),
                   number(pair.a.least(), 1), number(pair.b.least(), 1),
                   number(pair.ratio.median(), 2)});
        report->figure(std::string(f.name) + " worker_ms", pair.b.median());
        report->figure(std::string(f.name) + " worker/here", pair.ratio.median());
    }
    table.print();
}

void measure_least(report *report, workers *workers)
{
    static const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const std::string ppm = "P6\n1 1\n255\nabc";
    error error = {};
    const workers_image file = {ppm.data(), ppm.size(), "a.ppm", 16384};
    pair_of_samples pair = measure_pairs(
        5 * report->given().runs,
        [&](int) {
            return time_ms([&] {
                cage cage;
                check(workers_read_cage(workers, &cage, obj.data(), obj.size(), "a.obj", &error),
                      error);
                cage_finish(&cage);
            });
        },
        [&](int) {
            return time_ms([&] {
                image image;
                check(workers_read_image(workers, &image, &file, IMAGE_MAX_BYTES, &error), error);
                image_finish(&image);
            });
        });
    table table({"the least job", "ms", "least"});
    table.row({"cage", number(pair.a.median(), 2), number(pair.a.least(), 2)});
    table.row({"image", number(pair.b.median(), 2), number(pair.b.least(), 2)});
    table.print();
    report->figure("cage job_ms", pair.a.median());
    report->figure("image job_ms", pair.b.median());
}

void ask(report *report)
{
    workers workers;
    error error = {};
    const workers_limits limits{uint64_t{1} << 33, uint64_t{1} << 33, 60, 120};
    image_use_one_thread();
    check(workers_init(&workers, report->given().other("workers", "build").c_str(), &limits,
                       uint64_t{1} << 32, &error),
          error);
    measure_least(report, &workers);
    measure_pictures(report, &workers);
    workers_finish(&workers);
}

const question worker("worker", "what jobs cost in worker processes", {"workers"}, ask);

} // namespace
