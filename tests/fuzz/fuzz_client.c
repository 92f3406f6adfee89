/* A server that lies to libsheen. The first byte chooses what the client waits for, the second the
 * planes and encoding of the frame; the rest is what the server says before it hangs up. */
#include <fcntl.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/lib/session.h"
#include "tests/fuzz/fuzz.h"

#define WIDTH_PX 8
#define HEIGHT_PX 4
#define SEQ 1
#define MAX_BYTES 65536 /* a socket takes so many without a reader */

static void receive_frames(struct sheen_session *session, uint8_t choice)
{
    struct sheen_frame frame = {0};
    struct sheen_error error;
    for (uint32_t i = 0; i < 2; i++)
        session->pending[session->n_pending++] = (struct session_pending){
            .seq = SEQ + i,
            .render = {.width_px = WIDTH_PX,
                       .height_px = HEIGHT_PX,
                       .planes = choice & 0x80 ? CODEC_ALL_PLANES : 1,
                       .encoding = (sheen_Encoding)(choice % (sheen_Encoding_ENCODING_TIFF + 1))},
        };
    while (session->n_pending > 0 && sheen_receive(session, NULL, &frame, &error) == SHEEN_OK)
        MUST(frame.width_px == WIDTH_PX && frame.data_bytes > 0);
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
    MUST(write(ends[1], bytes + 2, size - 2) == (ssize_t)(size - 2));
    close(ends[1]);
    session =
        (struct sheen_session){.connection = {.fd = ends[0], .timeout_ms = 1000}, .last_seq = SEQ};
    if (bytes[0] < sizeof types)
        receive_answer(&session, types[bytes[0]]);
    else
        receive_frames(&session, bytes[1]);
    codec_decoder_destroy(session.decoder);
    connection_finish(&session.connection);
}
