/* bench_start [--sheend PROGRAM] [MODEL]: the time from the start of a private daemon to the first
 * picture, as a command without --server has it: connect, upload, a frame of 640x480. Alternately
 * planes, which sheend packs itself, and a PNG file. An unmeasured pair goes first, so that the
 * system's and the driver's caches are warm. */
#include "tests/bench/question.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "client/lib/sheen.h"
#include "tests/oracle/model.h"

namespace
{

void check(sheen_status status, const sheen_error &error)
{
    if (status != SHEEN_OK)
        throw std::runtime_error(error.text);
}

/* Milliseconds to the first frame, without the time in which the daemon ends. */
double first_frame(const std::string &path, const std::string &file, sheen_format format,
                   const char *device)
{
    const double start = now_ms();
    sheen_error error;
    sheen_session *session;
    sheen_connect_options options = sheen_connect_defaults();
    options.device = device;
    check(sheen_connect(&session, &options, &error), error);
    sheen_request request = sheen_request_defaults();
    sheen_frame frame = sheen_frame_defaults();
    request.width_px = 640;
    request.height_px = 480;
    request.format = format;
    sheen_file_id(file.data(), file.size(), request.model_id);
    check(sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, file.data(), file.size(),
                       path.c_str(), nullptr, &error),
          error);
    check(sheen_render(session, &request, nullptr, &frame, &error), error);
    const double taken = now_ms() - start;
    sheen_frame_finish(&frame);
    sheen_close(session);
    return taken;
}

void measure(report *report, table *table, const std::string &path, const char *device)
{
    std::ifstream stream(path, std::ios::binary);
    const std::string file((std::istreambuf_iterator<char>(stream)),
                           std::istreambuf_iterator<char>());
    pair_of_samples pair = measure_pairs(
        report->given().runs,
        [&](int) { return first_frame(path, file, SHEEN_FORMAT_ZSTD, device); },
        [&](int) { return first_frame(path, file, SHEEN_FORMAT_PNG, device); });
    const std::string name = model_name(path);
    table->row({name, count((double)read_cage_file(path)->n_faces), number(pair.a.median(), 0),
                number(pair.a.least(), 0), number(pair.b.median(), 0), number(pair.b.least(), 0)});
    report->figure(name + " first_planes_ms", pair.a.median());
    report->figure(name + " first_png_ms", pair.b.median());
}

void ask(report *report)
{
    const options &given = report->given();
    setenv("SHEEN_DAEMON", given.other("sheend", "build/sheend").c_str(), 1);
    table table({"start", "faces", "planes ms", "least", "PNG ms", "least"});
    std::string device = given.device();
    for (const std::string &path : bench_models(given))
        measure(report, &table, path, device.c_str());
    table.print();
}

const question start("start", "a private daemon from its start to its first frame",
                     {"device", "sheend"}, ask);

} // namespace
