/* Requests out, frames in. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client/lib/scene_convert.h"
#include "client/lib/session.h"
#include "client/lib/status.h"
#include "client/lib/times.h"

_Static_assert((int)SHEEN_MAX_IN_FLIGHT == (int)PROTOCOL_MAX_CREDITS, "what a daemon may grant");
_Static_assert((int)SHEEN_VIEW_ISO == (int)sheen_View_VIEW_ISO, "same order");
_Static_assert((int)SHEEN_CLASS_BATCH == (int)sheen_RequestClass_CLASS_BATCH, "same order");
_Static_assert((int)SHEEN_FORMAT_TIFF == (int)sheen_Encoding_ENCODING_TIFF, "same order");
_Static_assert((int)SHEEN_JPEG_420 == (int)sheen_JpegSubsampling_JPEG_420, "same order");
_Static_assert((int)SHEEN_PLANE_COVERAGE == (int)sheen_Plane_PLANE_COVERAGE, "same bits");

/* What a frame owns. */
struct sheen_frame_memory {
    uint8_t *data; /* a file's bytes, or what planes are unpacked from */
    size_t data_capacity;
    void *plane[SHEEN_N_PLANES];
    size_t plane_capacity[SHEEN_N_PLANES];
};

static void fill_camera(sheen_Render *render, const struct sheen_camera *camera)
{
    if (camera->projection == SHEEN_PROJECTION_AUTO)
        return;
    bool ortho = camera->projection == SHEEN_PROJECTION_ORTHOGRAPHIC;
    render->has_camera = true;
    render->camera = (sheen_Camera){
        .has_eye = !camera->auto_view,
        .eye = message_vec3(camera->eye),
        .has_target = !camera->auto_view || camera->has_target,
        .target = message_vec3(camera->target),
        .has_up = !camera->auto_up,
        .up = message_vec3(camera->up),
        .has_fov_deg = !ortho,
        .fov_deg = camera->fov_deg,
        .has_ortho_height = ortho,
        .ortho_height = camera->ortho_height,
        .has_view = camera->auto_view && camera->view != SHEEN_VIEW_AROUND,
        .view = (sheen_View)camera->view,
        .has_zoom = camera->zoom > 0,
        .zoom = camera->zoom,
        .has_zoom_x = camera->zoom > 0,
        .zoom_x = camera->zoom_at[0],
        .has_zoom_y = camera->zoom > 0,
        .zoom_y = camera->zoom_at[1],
    };
}

static void fill_render(sheen_Render *render, const struct sheen_request *request)
{
    *render = (sheen_Render){
        .width_px = request->width_px,
        .height_px = request->height_px,
        .has_miss = request->has_miss,
        .miss = message_colour(request->miss),
        .has_empty = request->has_empty,
        .empty = message_colour(request->empty),
        .has_base = request->has_base,
        .base = message_colour(request->base),
        .has_unfiltered = request->unfiltered,
        .unfiltered = request->unfiltered,
        .planes = request->planes,
        .encoding = (sheen_Encoding)request->format,
        .has_jpeg_quality = request->jpeg_quality != 0,
        .jpeg_quality = request->jpeg_quality,
        .has_jpeg_subsampling = request->jpeg_subsampling != SHEEN_JPEG_444,
        .jpeg_subsampling = (sheen_JpegSubsampling)request->jpeg_subsampling,
        .has_surface = request->surface != SHEEN_SURFACE_EXACT,
        .surface = (sheen_SurfaceKind)request->surface,
        .has_surface_level = request->surface_level != 0,
        .surface_level = request->surface_level,
        .has_request_class = request->request_class != SHEEN_CLASS_STILL,
        .request_class = (sheen_RequestClass)request->request_class,
        .has_view = request->has_view,
        .view = request->view,
        .has_deadline_ms = request->deadline_ms != 0,
        .deadline_ms = request->deadline_ms,
    };
    memcpy(render->model_sha256, request->model_id, SHEEN_ID_BYTES);
    fill_camera(render, &request->camera);
    lights_to_message(render, request);
}

static enum sheen_status too_old(struct sheen_error *error, const char *what)
{
    return status_set(error, SHEEN_BAD_ARGUMENT,
                      "the daemon is too old to %s: install sheen %s there", what, SHEEN_VERSION);
}

enum sheen_status sheen_send(struct sheen_session *session, const struct sheen_request *request,
                             struct sheen_error *error)
{
    char text[MESSAGE_TEXT_BYTES];
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    if (!request)
        return status_set(error, SHEEN_BAD_ARGUMENT, "request is NULL");
    if (session->n_pending == session->hello.credits)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%u request%s in flight: receive one",
                          session->hello.credits, session->hello.credits == 1 ? " is" : "s are");
    if (request->n_lights < 1 || request->n_lights > SHEEN_MAX_LIGHTS)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%u lights; there must be 1 to %d",
                          request->n_lights, SHEEN_MAX_LIGHTS);
    struct session_pending *pending = &session->pending[session->n_pending];
    pending->n_retries = 0;
    fill_render(&pending->render, request);
    if (!message_check_render(&pending->render, session->hello.max_width_px,
                              session->hello.max_height_px, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    if (session->hello.minor < 2 &&
        (pending->render.has_jpeg_quality || pending->render.has_jpeg_subsampling))
        return too_old(error, "choose the quality of JPEG files");
    status = session_send(session, MESSAGE_RENDER, &pending->render, &pending->seq, error);
    session->last_sent = pending->seq;
    if (!status)
        session->n_pending++;
    return status;
}

uint32_t sheen_last_number(const struct sheen_session *session)
{
    return session ? session->last_sent : 0;
}

/* The pending request of this number; n_pending when there is none. */
static size_t find_pending(const struct sheen_session *session, uint32_t seq)
{
    size_t i = 0;
    while (i < session->n_pending && session->pending[i].seq != seq)
        i++;
    return i;
}

enum sheen_status sheen_cancel(struct sheen_session *session, uint32_t number,
                               struct sheen_error *error)
{
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    if (find_pending(session, number) == session->n_pending)
        return status_set(error, SHEEN_BAD_ARGUMENT, "no request %u is in flight", number);
    if (session->hello.minor < 1)
        return too_old(error, "take requests back");
    return session_send_raw(session, MESSAGE_CANCEL, number, NULL, 0, error);
}

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

/* Makes a buffer hold `bytes`, keeping what is in it. */
static bool reserve(uint8_t **buffer, size_t *capacity, size_t bytes)
{
    if (bytes <= *capacity)
        return true;
    uint8_t *grown = realloc(*buffer, bytes);
    if (!grown)
        return false;
    *buffer = grown;
    *capacity = bytes;
    return true;
}

/* Reads all DATA of a frame. Memory grows with what has arrived, not with what was announced. */
static enum sheen_status read_data(struct sheen_session *session, uint32_t seq, size_t data_bytes,
                                   struct sheen_frame_memory *memory, struct sheen_error *error)
{
    size_t received = 0;
    while (received < data_bytes) {
        struct message_header header;
        enum sheen_status status = session_expect(session, seq, MESSAGE_DATA, NULL, &header, error);
        if (status)
            return status;
        if (header.length == 0 || header.length > data_bytes - received)
            return broken(session, error, "DATA is longer or shorter than its FRAME says");
        bool is_last = header.length == data_bytes - received;
        if (is_last != ((header.flags & MESSAGE_END) != 0))
            return broken(session, error, "the end of DATA is not where its FRAME says");
        size_t wanted = received + header.length;
        if (wanted > memory->data_capacity && wanted < data_bytes)
            wanted = 2 * wanted < data_bytes ? 2 * wanted : data_bytes;
        if (!reserve(&memory->data, &memory->data_capacity, wanted))
            return no_memory(session, error, data_bytes);
        status =
            connection_read(&session->connection, memory->data + received, header.length, error);
        if (status)
            return session_fail(session, status, error);
        received += header.length;
    }
    return SHEEN_OK;
}

static void fill_frame(struct sheen_frame *frame, const sheen_Frame *body)
{
    struct sheen_frame_memory *memory = frame->memory;
    *frame = (struct sheen_frame){
        .memory = memory,
        .number = frame->number,
        .width_px = body->width_px,
        .height_px = body->height_px,
        .planes = body->planes,
        .format = (enum sheen_format)body->encoding,
        .data_bytes = body->data_bytes,
        .camera = {.projection = body->camera.has_ortho_height ? SHEEN_PROJECTION_ORTHOGRAPHIC
                                                               : SHEEN_PROJECTION_PERSPECTIVE,
                   .fov_deg = body->camera.fov_deg,
                   .ortho_height = body->camera.ortho_height},
        .blank = body->blank,
        .light_share = body->has_light_share ? body->light_share : NAN,
        .up_source = body->has_up && body->has_up_source ? (enum sheen_up_source)body->up_source
                                                         : SHEEN_UP_UNKNOWN,
        .times = times_from_message(&body->times),
        .software = body->software,
    };
    message_get_vec3(frame->camera.eye, &body->camera.eye);
    message_get_vec3(frame->camera.target, &body->camera.target);
    message_get_vec3(frame->camera.up, &body->camera.up);
    message_get_vec3(frame->up, &body->up);
    lights_from_message(frame, body);
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
        if (!reserve(&grown, &memory->plane_capacity[plane], bytes))
            return no_memory(session, error, bytes);
        memory->plane[plane] = grown;
        frame->plane[plane] = grown;
    }
    const char *wrong = NULL;
    size_t size = (size_t)frame->data_bytes;
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

/* What a FRAME must be to answer its request; NULL when it is. */
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

/* The rest of a frame whose FRAME has been read. */
static enum sheen_status receive_frame(struct sheen_session *session,
                                       const struct session_pending *pending,
                                       const sheen_Frame *body, struct sheen_frame *frame,
                                       struct sheen_error *error)
{
    struct codec_layout layout;
    const char *mismatch = "FRAME has no size";
    if (codec_layout_init(&layout, body->width_px, body->height_px, body->planes))
        mismatch = frame_mismatch(body, pending, &layout);
    if (mismatch)
        return broken(session, error, mismatch);
    enum sheen_status status =
        read_data(session, pending->seq, (size_t)body->data_bytes, frame->memory, error);
    if (status)
        return status;
    fill_frame(frame, body);
    if (frame->format == SHEEN_FORMAT_RAW || frame->format == SHEEN_FORMAT_ZSTD)
        return unpack_planes(session, frame, &layout, error);
    frame->file = frame->memory->data;
    frame->file_bytes = (size_t)body->data_bytes;
    return SHEEN_OK;
}

/* The answer to a request, whose header has been read. */
static enum sheen_status receive_answer(struct sheen_session *session,
                                        const struct session_pending *pending,
                                        const struct message_header *header,
                                        struct sheen_frame *frame, struct sheen_error *error)
{
    sheen_Frame body;
    sheen_Superseded superseded;
    enum sheen_status status;
    switch (header->type) {
    case MESSAGE_ERROR:
        status = session_read_error(session, header, error);
        if (status == SHEEN_TOO_BIG) /* of a request, not of a file */
            return error ? error->status = SHEEN_BAD_REQUEST : SHEEN_BAD_REQUEST;
        return status;
    case MESSAGE_SUPERSEDED:
        status = session_read_body(session, header, &superseded, error);
        if (status)
            return status;
        frame->superseded_by = superseded.by;
        return status_set(error, SHEEN_SUPERSEDED, "request %u has taken the place of %u",
                          superseded.by, pending->seq);
    case MESSAGE_FRAME:
        status = session_read_body(session, header, &body, error);
        return status ? status : receive_frame(session, pending, &body, frame, error);
    default:
        return session_bad_peer(session, error, header->type, "another answer was due");
    }
}

/* The newer request of the same view that is in flight, and makes `pending` not worth another try;
 * NULL: none. Batches neither replace nor are replaced. */
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

/* The daemon's GPU was lost under the frame: sends its request again, which is in flight then. */
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

/* The next answer to any request in flight, which it ends. */
static enum sheen_status receive_next(struct sheen_session *session,
                                      const struct sheen_progress *progress,
                                      struct session_pending *pending, struct sheen_frame *frame,
                                      struct sheen_error *error)
{
    struct message_header header;
    enum sheen_status status = session_next(session, progress, &header, error);
    if (status)
        return status;
    if (header.type == MESSAGE_ERROR && header.seq == 0)
        return session_read_error(session, &header, error);
    size_t i = find_pending(session, header.seq);
    if (i == session->n_pending)
        return session_bad_peer(session, error, header.type, "it answers no request in flight");
    *pending = session->pending[i];
    session->n_pending--;
    memmove(session->pending + i, session->pending + i + 1,
            (session->n_pending - i) * sizeof(session->pending[0]));
    frame->number = pending->seq;
    frame->superseded_by = 0;
    return receive_answer(session, pending, &header, frame, error);
}

enum sheen_status sheen_receive(struct sheen_session *session,
                                const struct sheen_progress *progress, struct sheen_frame *frame,
                                struct sheen_error *error)
{
    struct session_pending pending = {.n_retries = SHEEN_MAX_RETRIES};
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    if (!frame || session->n_pending == 0)
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          frame ? "no request is in flight" : "frame is NULL");
    if (!frame->memory)
        frame->memory = calloc(1, sizeof(*frame->memory));
    if (!frame->memory)
        return no_memory(session, error, sizeof(*frame->memory));
    for (;;) {
        status = receive_next(session, progress, &pending, frame, error);
        if (status != SHEEN_GPU_LOST || pending.n_retries == SHEEN_MAX_RETRIES)
            return status;
        status = retry(session, &pending, frame, error);
        if (status)
            return status;
    }
}

enum sheen_status sheen_render(struct sheen_session *session, const struct sheen_request *request,
                               const struct sheen_progress *progress, struct sheen_frame *frame,
                               struct sheen_error *error)
{
    enum sheen_status status = session_check(session, error);
    if (!status && (!frame || session->n_pending))
        status = status_set(error, SHEEN_BAD_ARGUMENT,
                            "sheen_render() needs a frame, and no request in flight");
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
    *frame = (struct sheen_frame){0};
}
