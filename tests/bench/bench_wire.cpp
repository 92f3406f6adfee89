/* bench_wire [--sheend PROGRAM] [--frames N] [MODEL]: frames of 1920x1080 from a real daemon, over
 * a Unix socket and over TCP on loopback, in each encoding; the camera moves around the model.
 * Latency is the time from the request to the decoded frame, with one request in flight. "daemon's"
 * is the time from request to answer that the daemon took beyond rendering (visibility, evaluate,
 * shade, readback), including encoding. Then two requests are in flight: the frames for each
 * second, and their ratio to the renderer's own rate in that time. */
#include "tests/bench/question.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "client/lib/sheen.h"
#include "tests/bench/daemon.h"
#include "tests/oracle/scene.h"
#include "tests/oracle/model.h"

namespace
{

struct encoding {
    const char *name;
    sheen_format format;
};
const encoding encodings[] = {{"raw", SHEEN_FORMAT_RAW},
                              {"zstd", SHEEN_FORMAT_ZSTD},
                              {"jpeg", SHEEN_FORMAT_JPEG},
                              {"png", SHEEN_FORMAT_PNG}};

void check(sheen_status status, const sheen_error &error)
{
    if (status != SHEEN_OK)
        throw std::runtime_error(error.text);
}

/* One client with the model uploaded. */
class client
{
  public:
    client(const std::string &address, const std::string &path)
        : view(scene(read_cage_file(path)).request(1920, 1080))
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
        request.width_px = view.width_px;
        request.height_px = view.height_px;
        request.camera.projection = SHEEN_PROJECTION_PERSPECTIVE;
    }
    ~client()
    {
        sheen_frame_finish(&frame);
        sheen_close(session);
    }
    client(const client &) = delete;
    client &operator=(const client &) = delete;

    void send(sheen_format format)
    {
        orbit(&view.camera, 0.1);
        std::memcpy(request.camera.eye, view.camera.eye, sizeof request.camera.eye);
        std::memcpy(request.camera.target, view.camera.target, sizeof request.camera.target);
        std::memcpy(request.camera.up, view.camera.up, sizeof request.camera.up);
        request.camera.fov_deg = view.camera.fov_deg;
        request.format = format;
        check(sheen_send(session, &request, &error), error);
    }
    const sheen_frame &receive()
    {
        check(sheen_receive(session, nullptr, &frame, &error), error);
        return frame;
    }

  private:
    frame_request view;
    sheen_session *session = nullptr;
    sheen_request request = sheen_request_defaults();
    sheen_frame frame = sheen_frame_defaults();
    sheen_error error = {};
};

struct costs {
    samples latency, daemon, render, bytes;
    /* Two requests in flight: the share of the time in which the renderer works, and the daemon's
     * processor time. */
    double per_s = 0, busy = 0, cpu_ms = 0;
};

double render_ms(const sheen_times &t)
{
    return (double)(t.visibility_us + t.evaluate_us + t.shade_us + t.readback_us) / 1000;
}

costs measure(client *client, const daemon_process &daemon, sheen_format format, int frames)
{
    costs costs;
    for (int i = 0; i <= frames; i++) {
        double start = now_ms();
        client->send(format);
        const sheen_frame &frame = client->receive();
        double latency = now_ms() - start;
        const sheen_times &t = frame.times;
        if (i == 0)
            continue;
        costs.latency.add(latency);
        costs.render.add(render_ms(t));
        costs.daemon.add((double)t.total_us / 1000 - render_ms(t));
        costs.bytes.add((double)frame.data_bytes);
    }
    client->send(format);
    double start = now_ms(), cpu = daemon.cpu_ms(), rendered = 0;
    for (int i = 0; i < frames; i++) {
        client->send(format);
        rendered += render_ms(client->receive().times);
    }
    double elapsed = now_ms() - start;
    costs.per_s = frames / elapsed * 1000;
    costs.busy = rendered / elapsed;
    costs.cpu_ms = (daemon.cpu_ms() - cpu) / frames;
    client->receive();
    return costs;
}

void measure_transport(report *report, table *table, const std::string &transport,
                       const std::string &address, const daemon_process &daemon,
                       const std::string &path, int frames)
{
    client client(address, path);
    for (const encoding &encoding : encodings) {
        costs c = measure(&client, daemon, encoding.format, frames);
        table->row({transport, encoding.name, count(c.bytes.median()), number(c.render.median(), 1),
                    number(c.daemon.median(), 1), number(c.latency.percentile(50), 1),
                    number(c.latency.percentile(95), 1), number(c.latency.percentile(99), 1),
                    number(c.per_s, 2), number(c.busy, 2), number(c.cpu_ms, 0)});
        std::string key = transport + " " + encoding.name + " ";
        report->figure(key + "bytes", c.bytes.median());
        report->figure(key + "render_ms", c.render.median());
        report->figure(key + "daemon_ms", c.daemon.median());
        report->figure(key + "latency_p50_ms", c.latency.percentile(50));
        report->figure(key + "latency_p95_ms", c.latency.percentile(95));
        report->figure(key + "latency_p99_ms", c.latency.percentile(99));
        report->figure(key + "frames_per_s", c.per_s);
        report->figure(key + "of render rate ratio", c.busy);
    }
}

void ask(report *report)
{
    const options &given = report->given();
    int frames = std::stoi(given.other("frames", "20"));
    std::vector<std::string> models = bench_models(given);
    if (models.empty() || frames < 1)
        throw std::invalid_argument("a model and at least one frame are needed");
    daemon_process daemon(given.other("sheend", "build/sheend"), given.device());
    report->note("model", model_name(models[0]));
    table table({"wire", "coding", "bytes", "render ms", "daemon's ms", "p50 ms", "p95", "p99",
                 "frames/s of 2", "of render rate", "daemon CPU ms"});
    measure_transport(report, &table, "unix", daemon.unix_address, daemon, models[0], frames);
    measure_transport(report, &table, "tcp", daemon.tcp_address, daemon, models[0], frames);
    table.print();
}

const question wire("wire", "frames a second, bytes and latency of a daemon",
                    {"device", "sheend", "frames"}, ask);

} // namespace
