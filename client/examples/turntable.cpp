/* turntable MODEL FRAMES [ADDRESS]: asks for frames as the camera goes round, from an event loop
 * that could wait for other things too, and prints for each how much of it shows surface. The
 * planes come compressed and are decoded by the library.
 *
 *     c++ -std=c++17 turntable.cpp $(pkg-config --cflags --libs sheen) -o turntable */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include <poll.h>

#include <sheen.h>

namespace
{

struct failure : std::runtime_error {
    explicit failure(const sheen_error &error)
        : std::runtime_error(error.text), status(error.status)
    {
    }
    sheen_status status;
};

void check(sheen_status status, const sheen_error &error)
{
    if (status != SHEEN_OK)
        throw failure(error);
}

using session_pointer = std::unique_ptr<sheen_session, decltype(&sheen_close)>;

session_pointer open_session(const char *address, const sheen_request &request)
{
    sheen_error error;
    sheen_session *session;
    sheen_connect_options options = sheen_connect_defaults();
    options.address = address;
    std::memcpy(options.model_id, request.model_id, sizeof options.model_id);
    check(sheen_connect(&session, &options, &error), error);
    return session_pointer(session, sheen_close);
}

/* Waits for the next frame like an event loop, in which poll() would watch other descriptors,
 * too. */
void wait_for_frame(sheen_session *session, sheen_frame *frame)
{
    sheen_error error;
    sheen_status status;
    while ((status = sheen_try_receive(session, nullptr, frame, &error)) == SHEEN_AGAIN) {
        pollfd entry = {};
        entry.fd = sheen_descriptor(session, &entry.events);
        poll(&entry, 1, -1);
    }
    check(status, error);
}

/* The share of pixels that show the surface, 0 to 1. */
double share_of(const sheen_frame &frame)
{
    const auto *face =
        static_cast<const std::uint32_t(*)[3]>(frame.plane[3]); /* SHEEN_PLANE_PTEX */
    const std::size_t n = std::size_t(frame.width_px) * frame.height_px;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < n; i++)
        hits += face[i][0] != 0xffffffff;
    return double(hits) / double(n);
}

void run(const char *path, int n_frames, const char *address)
{
    sheen_error error;
    std::uint8_t *bytes;
    std::size_t n_bytes;
    check(sheen_read_file(SHEEN_FILE_MODEL, path, &bytes, &n_bytes, &error), error);
    const std::unique_ptr<std::uint8_t, decltype(&std::free)> file(bytes, std::free);
    sheen_request request = sheen_request_defaults();
    sheen_frame frame = sheen_frame_defaults();
    std::unique_ptr<sheen_frame, decltype(&sheen_frame_finish)> owner(&frame, sheen_frame_finish);
    sheen_file_id(bytes, n_bytes, request.model_id);
    const session_pointer session = open_session(address, request);
    check(sheen_upload(session.get(), SHEEN_FILE_MODEL, request.model_id, bytes, n_bytes, path,
                       nullptr, &error),
          error);
    request.width_px = 160;
    request.height_px = 120;
    request.format = SHEEN_FORMAT_ZSTD;
    request.planes = SHEEN_PLANE_COLOUR | SHEEN_PLANE_PTEX;
    for (int i = 0; i < n_frames; i++) {
        check(sheen_send(session.get(), &request, &error), error);
        wait_for_frame(session.get(), &frame);
        std::printf("%d: %.3f\n", i, share_of(frame));
        /* The first camera is chosen by the daemon; then it turns about the z axis. */
        request.camera = frame.camera;
        const double angle = 2 * std::acos(-1.0) / n_frames;
        const double x = frame.camera.eye[0] - frame.camera.target[0];
        const double y = frame.camera.eye[1] - frame.camera.target[1];
        request.camera.eye[0] = frame.camera.target[0] + x * std::cos(angle) - y * std::sin(angle);
        request.camera.eye[1] = frame.camera.target[1] + x * std::sin(angle) + y * std::cos(angle);
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: turntable MODEL FRAMES [ADDRESS]\n");
        return 2;
    }
    try {
        run(argv[1], int(std::strtol(argv[2], nullptr, 10)), argc > 3 ? argv[3] : nullptr);
    } catch (const failure &reason) {
        std::fprintf(stderr, "turntable: %s\n", reason.what());
        return sheen_status_exit_code(reason.status);
    }
    return 0;
}
