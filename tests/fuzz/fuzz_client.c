/* A server that sends wrong data to libsheen. The first byte chooses what the client requests, the
 * second the planes and the encoding of the frame; the rest is what the server sends before it
 * closes. For frames, the first byte also gives the share of that data after which the client
 * receives without waiting. */
#include <fcntl.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/lib/session.h"
#include "tests/fuzz/fuzz.h"

#define WIDTH_PX 8
#define HEIGHT_PX 4
#define SEQ 1
#define MAX_BYTES 65536 /* a socket accepts this many bytes without a reader */

/* `late`: the data that the server sends after the client's first call */
static void receive_frames(struct sheen_session *session, uint8_t choice, int server,
                           const uint8_t *late, size_t n_late)
{
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_error error;
    for (uint32_t i = 0; i < 2; i++)
        session->pending[session->n_pending++] = (struct session_pending){
            .seq = SEQ + i,
            .render = {.width_px = WIDTH_PX,
                       .height_px = HEIGHT_PX,
                       .planes = choice & 0x80 ? CODEC_ALL_PLANES : 1,
                       .encoding = (sheen_Encoding)(choice % (sheen_Encoding_ENCODING_TIFF + 1))},
        };
    enum sheen_status status = sheen_try_receive(session, NULL, &frame, &error);
    MUST(write(server, late, n_late) == (ssize_t)n_late);
    close(server);
    if (status != SHEEN_OK && status != SHEEN_AGAIN)
        goto finish;
    while (session->n_pending > 0 && sheen_receive(session, NULL, &frame, &error) == SHEEN_OK)
        MUST(frame.width_px == WIDTH_PX && frame.data_bytes > 0);
finish:
    sheen_frame_finish(&frame);
}

static void receive_answer(struct sheen_session *session, uint8_t type)
{
    static union {
        sheen_HelloOk hello_ok;
        sheen_UploadState upload_state;
        sheen_ModelInfo model_info;
        sheen_Stats stats;
    } body;
    struct sheen_error error;
    session_receive(session, SEQ, type, NULL, &body, &error);
}

/* A computation, whose request has the number after SEQ. */
static void find_breaks(struct sheen_session *session)
{
    const struct sheen_request request = SHEEN_REQUEST_DEFAULTS;
    struct sheen_breaks breaks = SHEEN_BREAKS_DEFAULTS;
    struct sheen_error error;
    session->hello.minor = PROTOCOL_MINOR;
    if (sheen_find_breaks(session, &request, NULL, NULL, &breaks, &error) == SHEEN_OK)
        for (uint32_t i = 0; i < breaks.n_edges; i++)
            MUST(breaks.edges[i].length >= 0 && breaks.edges[i].worst[0].uv[0] <= 1 + 1e-9);
    sheen_breaks_finish(&breaks);
}

static void trace_lines(struct sheen_session *session)
{
    const struct sheen_request request = SHEEN_REQUEST_DEFAULTS;
    struct sheen_curves curves = SHEEN_CURVES_DEFAULTS;
    struct sheen_error error;
    session->hello.minor = PROTOCOL_MINOR;
    if (sheen_trace_lines(session, &request, NULL, NULL, &curves, &error) == SHEEN_OK) {
        size_t n_points = 0;
        for (uint32_t i = 0; i < curves.n_curves; i++)
            n_points += curves.curves[i].n_points;
        MUST(n_points == curves.n_points);
        for (uint32_t i = 0; i < curves.n_curves; i++)
            MUST(curves.curves[i].points[curves.curves[i].n_points - 1].length >= 0);
    }
    sheen_curves_finish(&curves);
}

void fuzz_one(const uint8_t *bytes, size_t size)
{
    static const uint8_t types[] = {MESSAGE_HELLO_OK, MESSAGE_UPLOAD_STATE, MESSAGE_MODEL_INFO,
                                    MESSAGE_STATS};
    static struct sheen_session session;
    int ends[2];
    if (size < 2 || size > MAX_BYTES)
        return;
    MUST(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0);
    MUST(fcntl(ends[0], F_SETFL, O_NONBLOCK) == 0);
    bool is_breaks = bytes[0] == sizeof types, is_lines = bytes[0] == sizeof types + 1;
    bool is_frames = bytes[0] > sizeof types + 1;
    size_t n_late = is_frames ? (size - 2) * bytes[0] / 256 : 0, n_early = size - 2 - n_late;
    MUST(write(ends[1], bytes + 2, n_early) == (ssize_t)n_early);
    session =
        (struct sheen_session){.connection = {.fd = ends[0], .timeout_ms = 1000}, .last_seq = SEQ};
    if (is_frames) {
        receive_frames(&session, bytes[1], ends[1], bytes + 2 + n_early, n_late);
    } else if (is_breaks || is_lines) {
        MUST(shutdown(ends[1], SHUT_WR) == 0); /* the request must find a reader */
        if (is_lines)
            trace_lines(&session);
        else
            find_breaks(&session);
        close(ends[1]);
    } else {
        close(ends[1]);
        receive_answer(&session, types[bytes[0]]);
    }
    codec_decoder_destroy(session.decoder);
    connection_finish(&session.connection);
}
