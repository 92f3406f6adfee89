/* Receives frames. An answer is read in steps, each of which can stop at any byte and continue
 * later. */
#include <stdlib.h>
#include <string.h>

#include "client/lib/data.h"
#include "client/lib/scene_convert.h"
#include "client/lib/session.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"
#include "client/lib/times.h"

/* The memory that a frame owns. */
struct sheen_frame_memory {
    uint8_t *data; /* the bytes of a file, or the data that planes are decoded from */
    size_t data_capacity;
    void *plane[SHEEN_N_PLANES];
    size_t plane_capacity[SHEEN_N_PLANES];
};

static enum sheen_status broken(struct sheen_session *session, struct sheen_error *error,
                                const char *what)
{
    status_set(error, SHEEN_BAD_PEER, "the server broke the protocol: %s", what);
    return session_fail(session, SHEEN_BAD_PEER, error);
}

static enum sheen_status no_memory(struct sheen_session *session, struct sheen_error *error,
                                   size_t bytes)
{
    status_set(error, SHEEN_NO_MEMORY, "no memory for a frame of %zu bytes", bytes);
    return session_fail(session, SHEEN_NO_MEMORY, error);
}

static void fill_frame(struct sheen_frame *frame, const sheen_Frame *body)
{
    *frame = (struct sheen_frame){
        .memory = frame->memory,
        .number = frame->number,
        .width_px = body->width_px,
        .height_px = body->height_px,
        .planes = body->planes,
        .format = (enum sheen_format)body->encoding,
        .data_bytes = (size_t)body->data_bytes,
        .times = times_from_message(&body->times),
        .software = body->software,
        .threads = body->threads,
    };
    scene_from_message(frame, body);
    memcpy(frame->device, body->device, sizeof(frame->device));
    memcpy(frame->driver, body->driver, sizeof(frame->driver));
    memcpy(frame->server, body->server, sizeof(frame->server));
}

static enum sheen_status unpack_planes(struct sheen_session *session, struct sheen_frame *frame,
                                       const struct codec_layout *layout, struct sheen_error *error)
{
    struct sheen_frame_memory *memory = frame->memory;
    for (unsigned plane = 0; plane < SHEEN_N_PLANES; plane++) {
        if (!(layout->planes & 1u << plane))
            continue;
        size_t bytes = codec_plane_bytes(layout, plane);
        uint8_t *grown = memory->plane[plane];
        if (!data_reserve(&grown, &memory->plane_capacity[plane], bytes))
            return no_memory(session, error, bytes);
        memory->plane[plane] = grown;
        frame->plane[plane] = grown;
    }
    const char *wrong = NULL;
    size_t size = frame->data_bytes;
    if (frame->format == SHEEN_FORMAT_RAW) {
        wrong = codec_raw_decode(layout, memory->data, size, frame->plane);
    } else {
        if (!session->decoder)
            session->decoder = codec_decoder_create();
        if (!session->decoder)
            return no_memory(session, error, size);
        wrong = codec_zstd_decode(session->decoder, layout, memory->data, size, frame->plane);
    }
    return wrong ? broken(session, error, wrong) : SHEEN_OK;
}

/* Checks that a FRAME answers its request. Returns NULL, or what differs. */
static const char *frame_mismatch(const sheen_Frame *body, const struct session_pending *pending,
                                  const struct codec_layout *layout)
{
    const sheen_Render *asked = &pending->render;
    if (body->width_px != asked->width_px || body->height_px != asked->height_px ||
        body->planes != asked->planes || body->encoding != asked->encoding)
        return "FRAME is not of the size, planes and encoding that were asked for";
    if (body->encoding == sheen_Encoding_ENCODING_RAW && body->data_bytes != layout->raw_bytes)
        return "FRAME has another number of bytes than its planes";
    if (body->encoding == sheen_Encoding_ENCODING_ZSTD &&
        body->data_bytes > codec_zstd_bound(layout))
        return "FRAME has more bytes than its planes can take";
    return NULL;
}

/* Starts a frame, whose FRAME is the next message. The data goes into the buffer of `memory`. */
static enum sheen_status open_answer(struct sheen_session *session,
                                     const struct session_pending *pending,
                                     const struct message_header *header,
                                     struct sheen_frame_memory *memory, struct sheen_error *error)
{
    struct session_answer *answer = &session->answer;
    const char *mismatch = "FRAME has no size";
    enum sheen_status status = session_read_body(session, header, &answer->body, error);
    if (status)
        return status;
    const sheen_Frame *body = &answer->body;
    if (codec_layout_init(&answer->layout, body->width_px, body->height_px, body->planes))
        mismatch = frame_mismatch(body, pending, &answer->layout);
    if (mismatch)
        return broken(session, error, mismatch);
    answer->is_open = true;
    answer->seq = pending->seq;
    answer->data = (struct session_data){memory->data, memory->data_capacity, 0};
    memory->data = NULL;
    memory->data_capacity = 0;
    return SHEEN_OK;
}

/* Ends the frame, complete or not. The buffer goes to `memory`, which belongs to the frame that the
 * program passes now. */
static void close_answer(struct sheen_session *session, struct sheen_frame_memory *memory)
{
    struct session_answer *answer = &session->answer;
    free(memory->data);
    memory->data = answer->data.bytes;
    memory->data_capacity = answer->data.capacity;
    answer->data = (struct session_data){NULL, 0, 0};
    answer->is_open = false;
}

/* Finishes a frame whose data is complete. */
static enum sheen_status finish_frame(struct sheen_session *session,
                                      const struct session_pending *pending,
                                      struct sheen_frame *frame, struct sheen_error *error)
{
    fill_frame(frame, &session->answer.body);
    bool is_planes = frame->format == SHEEN_FORMAT_RAW || frame->format == SHEEN_FORMAT_ZSTD;
    if (is_planes && !pending->undecoded)
        return unpack_planes(session, frame, &session->answer.layout, error);
    frame->data = frame->memory->data;
    return SHEEN_OK;
}

/* Reads an answer other than a frame; its header was read already. */
static enum sheen_status read_refusal(struct sheen_session *session, uint32_t seq,
                                      const struct message_header *header,
                                      struct sheen_frame *frame, struct sheen_error *error)
{
    sheen_Superseded superseded;
    enum sheen_status status;
    switch (header->type) {
    case MESSAGE_ERROR:
        status = session_read_error(session, header, error);
        if (status == SHEEN_TOO_BIG) /* the request is too big here, not a file */
            return error ? error->status = SHEEN_BAD_REQUEST : SHEEN_BAD_REQUEST;
        return status;
    case MESSAGE_SUPERSEDED:
        status = session_read_body(session, header, &superseded, error);
        if (status)
            return status;
        frame->superseded_by = superseded.by;
        return status_set(error, SHEEN_SUPERSEDED, "request %u has taken the place of %u",
                          superseded.by, seq);
    default:
        return session_bad_peer(session, error, header->type, "another answer was due");
    }
}

/* The newer request of the same view in flight, because of which `pending` is not sent again; NULL
 * if there is none. Batches neither replace nor are replaced. */
static const struct session_pending *find_newer(const struct sheen_session *session,
                                                const struct session_pending *pending)
{
    const sheen_Render *old = &pending->render;
    if (!old->has_view && old->request_class != sheen_RequestClass_CLASS_INTERACTIVE)
        return NULL;
    for (size_t i = session->n_pending; i > 0; i--) {
        const struct session_pending *other = &session->pending[i - 1];
        const sheen_Render *new = &other->render;
        bool has_view = new->has_view || new->request_class == sheen_RequestClass_CLASS_INTERACTIVE;
        if (has_view && new->view == old->view && (int32_t)(other->seq - pending->seq) > 0 &&
            old->request_class != sheen_RequestClass_CLASS_BATCH &&new->request_class !=
                sheen_RequestClass_CLASS_BATCH)
            return other;
    }
    return NULL;
}

/* The frame was lost with the daemon's GPU: sends its request again, which is then in flight. */
static enum sheen_status retry(struct sheen_session *session, const struct session_pending *lost,
                               struct sheen_frame *frame, struct sheen_error *error)
{
    const struct session_pending *newer = find_newer(session, lost);
    if (newer) {
        frame->superseded_by = newer->seq;
        return status_set(error, SHEEN_SUPERSEDED, "request %u has taken the place of %u",
                          newer->seq, lost->seq);
    }
    struct session_pending *again = &session->pending[session->n_pending++];
    *again = *lost;
    again->n_retries++;
    return session_send_again(session, MESSAGE_RENDER, &again->render, again->seq, error);
}

static void remove_pending(struct sheen_session *session, size_t i)
{
    session->n_pending--;
    memmove(session->pending + i, session->pending + i + 1,
            (session->n_pending - i) * sizeof(session->pending[0]));
}

/* Reads the next answer as far as it has come. *pending is set as soon as the answered request is
 * known; a FRAME opens session->answer. */
static enum sheen_status read_answer(struct sheen_session *session,
                                     const struct sheen_progress *progress,
                                     struct session_pending *pending, struct sheen_frame *frame,
                                     struct sheen_error *error)
{
    struct session_answer *answer = &session->answer;
    struct message_header header;
    enum sheen_status status;
    if (!answer->is_open) {
        status = session_next(session, progress, &header, error);
        if (status)
            return status;
        if (header.type == MESSAGE_ERROR && header.seq == 0)
            return session_read_error(session, &header, error);
    }
    size_t i = session_find_pending(session, answer->is_open ? answer->seq : header.seq);
    if (i == session->n_pending)
        return session_bad_peer(session, error, header.type, "it answers no request in flight");
    *pending = session->pending[i];
    if (!answer->is_open && header.type != MESSAGE_FRAME)
        return read_refusal(session, pending->seq, &header, frame, error);
    if (!answer->is_open) {
        status = open_answer(session, pending, &header, frame->memory, error);
        if (status)
            return status;
    }
    return data_read(session, answer->seq, (size_t)answer->body.data_bytes, &answer->data, error);
}

/* Receives the next answer to any request in flight, which then is in flight no more. */
static enum sheen_status receive_next(struct sheen_session *session,
                                      const struct sheen_progress *progress,
                                      struct session_pending *pending, struct sheen_frame *frame,
                                      struct sheen_error *error)
{
    pending->seq = 0;
    frame->superseded_by = 0;
    enum sheen_status status = read_answer(session, progress, pending, frame, error);
    if (status == SHEEN_AGAIN)
        return status;
    frame->number = pending->seq;
    if (session->answer.is_open) {
        close_answer(session, frame->memory);
        if (!status)
            status = finish_frame(session, pending, frame, error);
    }
    size_t i = session_find_pending(session, pending->seq);
    if (i < session->n_pending)
        remove_pending(session, i);
    return status;
}

/* Receives into a frame of this library's own size. */
static enum sheen_status receive_whole(struct sheen_session *session,
                                       const struct sheen_progress *progress,
                                       struct sheen_frame *frame, struct sheen_error *error)
{
    struct session_pending pending = {.n_retries = SHEEN_MAX_RETRIES};
    for (;;) {
        enum sheen_status status = receive_next(session, progress, &pending, frame, error);
        if (status != SHEEN_GPU_LOST || pending.n_retries == SHEEN_MAX_RETRIES)
            return status;
        status = retry(session, &pending, frame, error);
        if (status)
            return status;
    }
}

static enum sheen_status receive(struct sheen_session *session, bool must_not_wait,
                                 const struct sheen_progress *progress, struct sheen_frame *frame,
                                 struct sheen_error *error)
{
    enum sheen_status status = session_check(session, error);
    if (!status)
        status = sized_check(frame, "frame", error);
    if (status)
        return status;
    if (session->n_pending == 0)
        return status_set(error, SHEEN_BAD_ARGUMENT, "no request is in flight");
    if (!frame->memory)
        frame->memory = calloc(1, sizeof(*frame->memory));
    if (!frame->memory)
        return no_memory(session, error, sizeof(*frame->memory));
    struct sheen_frame whole = {.memory = frame->memory};
    session->connection.must_not_wait = must_not_wait;
    status = receive_whole(session, progress, &whole, error);
    session->connection.must_not_wait = false;
    if (status != SHEEN_AGAIN)
        sized_give(frame, &whole, sizeof(whole));
    return status;
}

enum sheen_status sheen_receive(struct sheen_session *session,
                                const struct sheen_progress *progress, struct sheen_frame *frame,
                                struct sheen_error *error)
{
    return receive(session, false, progress, frame, error);
}

enum sheen_status sheen_try_receive(struct sheen_session *session,
                                    const struct sheen_progress *progress,
                                    struct sheen_frame *frame, struct sheen_error *error)
{
    return receive(session, true, progress, frame, error);
}

enum sheen_status sheen_render(struct sheen_session *session, const struct sheen_request *request,
                               const struct sheen_progress *progress, struct sheen_frame *frame,
                               struct sheen_error *error)
{
    enum sheen_status status = session_check(session, error);
    if (!status)
        status = sized_check(frame, "frame", error);
    if (!status && session->n_pending)
        status = status_set(error, SHEEN_BAD_ARGUMENT,
                            "sheen_render() needs that no request is in flight");
    if (!status)
        status = sheen_send(session, request, error);
    return status ? status : sheen_receive(session, progress, frame, error);
}

void sheen_frame_finish(struct sheen_frame *frame)
{
    if (!frame)
        return;
    if (frame->memory) {
        free(frame->memory->data);
        for (unsigned plane = 0; plane < SHEEN_N_PLANES; plane++)
            free(frame->memory->plane[plane]);
        free(frame->memory);
    }
    if (frame->size)
        sheen_struct_init(frame, frame->size);
}
