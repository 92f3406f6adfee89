/* bench_png [--sheend PROGRAM] [MODEL]...: PNG files of 1280x720 by the daemon's threads: the wall
 * time from the finished frame to the finished file (encode_us, one request at a time), and the
 * processor time of one thread that encodes the same pixels. Beside it libpng as OpenImageIO uses
 * it, with which a worker process wrote these files before: Sub, level 4, with alpha. */
#include "tests/bench/question.h"

#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <vector>

#include <png.h>

extern "C" {
#include "server/output/png.h"
}
#include "client/lib/sheen.h"
#include "tests/bench/daemon.h"
#include "tests/oracle/model.h"

namespace
{

constexpr uint32_t width_px = 1280, height_px = 720;
const int peer_level = 4;

struct subject {
    const char *name;
    double opacity; /* of the default light's stripes */
    sheen_show_kind show;
};
const subject subjects[] = {{"lines", 1, SHEEN_SHOW_LINES},
                            {"shaded surface", 0, SHEEN_SHOW_LINES},
                            {"lines over it", 0.5, SHEEN_SHOW_LINES},
                            {"mean curvature", 1, SHEEN_SHOW_MEAN}};

void check(sheen_status status, const sheen_error &error)
{
    if (status != SHEEN_OK)
        throw std::runtime_error(error.text);
}

double processor_ms()
{
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}

/* One client with the model uploaded. */
class client
{
  public:
    client(const std::string &address, const std::string &path)
    {
        std::ifstream file(path, std::ios::binary);
        std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        sheen_connect_options options = sheen_connect_defaults();
        options.address = address.c_str();
        check(sheen_connect(&session, &options, &error), error);
        sheen_file_id(bytes.data(), bytes.size(), request.model_id);
        check(sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, bytes.data(), bytes.size(),
                           path.c_str(), nullptr, &error),
              error);
        request.width_px = width_px;
        request.height_px = height_px;
    }
    ~client()
    {
        sheen_frame_finish(&frame);
        sheen_close(session);
    }
    client(const client &) = delete;
    client &operator=(const client &) = delete;

    const sheen_frame &draw(const subject &subject, sheen_format format)
    {
        request.lights[0].pattern.opacity = subject.opacity;
        request.show.kind = subject.show;
        request.format = format;
        check(sheen_render(session, &request, nullptr, &frame, &error), error);
        return frame;
    }

  private:
    sheen_session *session = nullptr;
    sheen_request request = sheen_request_defaults();
    sheen_frame frame = sheen_frame_defaults();
    sheen_error error = {};
};

/* All strips of a picture by one thread. Returns the file's bytes without its head. */
size_t encode(png_encoder *encoder, const std::vector<uint8_t> &rgba)
{
    strip_layout layout;
    png_layout_init(&layout, width_px, height_px);
    std::vector<uint8_t> row(png_row_bytes(&layout)), bytes(layout.bound);
    bool has_alpha = false;
    for (size_t i = 0; i < layout.n; i++)
        has_alpha |= !png_strip_is_opaque(&layout, i, rgba.data());
    size_t size = 0;
    for (size_t i = 0; i < layout.n; i++) {
        png_strip strip;
        error error;
        if (!png_strip_encode(encoder, &layout, i, rgba.data(), has_alpha, row.data(), bytes.data(),
                              &strip, &error))
            throw std::runtime_error(error.text);
        size += strip.size;
    }
    return size;
}

void count_bytes(png_structp png, png_bytep, size_t n)
{
    *static_cast<size_t *>(png_get_io_ptr(png)) += n;
}

size_t encode_by_libpng(const std::vector<uint8_t> &rgba)
{
    size_t size = 0;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &size, count_bytes, nullptr);
    png_set_compression_level(png, peer_level);
    png_set_filter(png, 0, PNG_FILTER_SUB);
    png_set_IHDR(png, info, width_px, height_px, 8, PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (size_t y = 0; y < height_px; y++)
        png_write_row(png, &rgba[4 * y * width_px]);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return size;
}

void measure(report *report, table *table, client *client, const std::string &model,
             const subject &subject)
{
    const sheen_frame &planes = client->draw(subject, SHEEN_FORMAT_RAW);
    auto *colour = static_cast<const uint8_t *>(planes.plane[0]);
    const std::vector<uint8_t> rgba(colour, colour + size_t{4} * width_px * height_px);
    std::unique_ptr<png_encoder, void (*)(png_encoder *)> encoder(png_encoder_create(),
                                                                  png_encoder_destroy);
    samples wall, ours, theirs;
    size_t size = 0, our_size = 0, their_size = 0;
    for (int run = 0; run <= report->given().runs; run++) {
        const sheen_frame &file = client->draw(subject, SHEEN_FORMAT_PNG);
        double start = processor_ms();
        our_size = encode(encoder.get(), rgba);
        double middle = processor_ms();
        their_size = encode_by_libpng(rgba);
        double end = processor_ms();
        if (run == 0)
            continue;
        size = file.data_bytes;
        wall.add((double)file.times.encode_us / 1000);
        ours.add(middle - start);
        theirs.add(end - middle);
    }
    double of_bytes = (double)our_size / (double)their_size;
    double ratio = theirs.median() / ours.median();
    table->row({model + ", " + subject.name, count((double)size), number(of_bytes, 2),
                number(wall.median(), 1), number(wall.least(), 1), number(ours.median(), 1),
                number(ours.least(), 1), number(theirs.median(), 1), number(ratio, 2)});
    std::string key = model + " " + subject.name + " ";
    report->figure(key + "bytes", (double)size);
    report->figure(key + "bytes/libpng", of_bytes);
    report->figure(key + "wall_ms", wall.median());
    report->figure(key + "least_wall_ms", wall.least());
    report->figure(key + "processor_ms", ours.median());
    report->figure(key + "libpng/ours ratio", ratio);
}

void ask(report *report)
{
    const options &given = report->given();
    daemon_process daemon(given.other("sheend", "build/sheend"), given.device());
    table table({"PNG of 1280x720", "bytes", "of libpng's", "daemon's wall ms", "least",
                 "processor ms", "least", "libpng's", "libpng/ours"});
    for (const std::string &path : bench_models(given)) {
        client client(daemon.unix_address, path);
        for (const subject &subject : subjects)
            measure(report, &table, &client, model_name(path), subject);
    }
    table.print();
}

const question png_question("png", "PNG files by the daemon's threads", {"device", "sheend"}, ask);

} // namespace
