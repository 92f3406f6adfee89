#include "client/cli/stream/frames.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/base/clock.h"
#include "client/cli/base/failure.h"
#include "client/cli/files/file.h"
#include "client/cli/notices.h"
#include "client/cli/turntable.h"

/* The longer side of the small frame that is drawn only to learn the camera. */
#define PROBE_PX 64
#define IN_FLIGHT 2u    /* while a frame is transferred, the next request waits at the daemon */
#define LIGHT_SWING 0.1 /* largest shift of the light, as a share of its u edge */

static volatile sig_atomic_t interrupted;

static void interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

void stream_end_at_interrupt(void)
{
    const struct sigaction action = {.sa_handler = interrupt,
                                     .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    sigaction(SIGINT, &action, NULL);
}

bool stream_is_interrupted(void)
{
    return interrupted;
}

static void move(struct stream *stream, const struct options *options, uint32_t number)
{
    const double degree = 3.14159265358979323846 / 180;
    double angle = number * options->orbit_deg * degree;
    /* Every frame is wanted: no request may replace another. */
    stream->request.has_view = stream->request.request_class != SHEEN_CLASS_BATCH;
    stream->request.view = number;
    stream->request.camera = stream->camera;
    stream->request.lights[0] = stream->light;
    if (!options->light_only) {
        turntable_turn(&stream->camera, stream->axis, angle, &stream->request.camera);
        return;
    }
    for (int i = 0; i < 3; i++)
        stream->request.lights[0].centre[i] += LIGHT_SWING * sin(angle) * stream->light.u[i];
}

static enum sheen_status send_one(struct client *client, struct stream *stream, uint32_t number)
{
    struct sent sent = {.frame = number, .us = clock_now_us()};
    enum sheen_status status = sheen_send(client->session, &stream->request, &client->error);
    stream->sent[sheen_last_number(client->session) % SHEEN_MAX_IN_FLIGHT] = sent;
    return status;
}

/* Writes a frame's file. Only then the frame counts as drawn: after the loss of a server, exactly
 * the frames without a file are requested again. */
static enum sheen_status write_one(struct client *client, struct stream *stream,
                                   const struct options *options, uint32_t number)
{
    if (!options->output)
        return SHEEN_OK;
    char *path = frame_names_path(&options->frame_names, number);
    if (!path)
        return failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for a file's name");
    enum sheen_status status =
        file_write(path, stream->frame.data, stream->frame.data_bytes, &client->error);
    free(path);
    if (!status)
        stream->written_bytes += stream->frame.data_bytes;
    return status;
}

/* Keeps the range of the first frame's false colour for all frames, so that a colour means one
 * value. */
static void keep_range(struct stream *stream)
{
    struct sheen_show *show = &stream->request.show;
    if (show->kind != SHEEN_SHOW_LINES && show->range == 0)
        show->range = stream->frame.show_range;
}

static enum sheen_status receive_one(struct client *client, struct stream *stream,
                                     const struct options *options)
{
    enum sheen_status status =
        sheen_receive(client->session, &client->report, &stream->frame, &client->error);
    const struct sent *sent = &stream->sent[stream->frame.number % SHEEN_MAX_IN_FLIGHT];
    bool is_late = status == SHEEN_LATE && stream->request.deadline_ms;
    if (status && !is_late)
        return status;
    client_answered(client);
    if (is_late) {
        stream->records[sent->frame].state = LATE;
        stream->n_late++;
        return SHEEN_OK;
    }
    keep_range(stream);
    const struct sheen_times *times = &stream->frame.times;
    uint64_t round_trip_us = (uint64_t)(clock_now_us() - sent->us);
    status = write_one(client, stream, options, sent->frame);
    if (status)
        return status;
    stream->n_drawn++;
    stream->records[sent->frame] = (struct record){
        .state = DRAWN,
        .number = sent->frame,
        .stage_us = {times->tables_us, times->visibility_us, times->evaluate_us, times->shade_us,
                     times->readback_us, times->encode_us, times->total_us, round_trip_us},
        .data_bytes = stream->frame.data_bytes,
    };
    return SHEEN_OK;
}

static void keep_axis(struct stream *stream, const struct sheen_frame *frame)
{
    const double *up = frame->up_source == SHEEN_UP_UNKNOWN ? frame->camera.up : frame->up;
    memcpy(stream->axis, up, sizeof(stream->axis));
    stream->up_source = frame->up_source;
}

/* Places the turntable's camera by the daemon's own camera and the model's box. */
static void place_camera(struct stream *stream, const struct options *options,
                         const struct sheen_frame *frame, const struct sheen_model_info *info)
{
    const struct sheen_camera *asked = &options->request.camera;
    double middle[3];
    for (int i = 0; i < 3; i++)
        middle[i] = 0.5 * (info->box_min[i] + info->box_max[i]);
    stream->camera = frame->camera;
    keep_axis(stream, frame);
    turntable_fit(&stream->camera, stream->axis, info->box_min, info->box_max,
                  (double)stream->request.width_px / stream->request.height_px,
                  asked->has_target ? NULL : middle);
    stream->camera.projection =
        options->given & GIVEN_ORTHO ? SHEEN_PROJECTION_ORTHOGRAPHIC : SHEEN_PROJECTION_PERSPECTIVE;
    stream->camera.fov_deg = asked->fov_deg;
    stream->camera.ortho_height = asked->ortho_height;
    stream->camera.zoom = asked->zoom;
    memcpy(stream->camera.zoom_at, asked->zoom_at, sizeof(asked->zoom_at));
    stream->request.camera = stream->camera;
    stream->tables_us = frame->times.tables_us;
    stream->has_camera = true;
}

/* If no eye is given: a small frame with the daemon's camera tells the side from which it looks and
 * the up direction; the model's info tells its middle. */
static enum sheen_status find_camera(struct client *client, struct stream *stream,
                                     const struct options *options)
{
    struct sheen_request probe = options->request;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    memcpy(probe.model_id, client->model_id, SHEEN_ID_BYTES);
    uint32_t longer = probe.width_px > probe.height_px ? probe.width_px : probe.height_px;
    double scale = fmin(1, (double)PROBE_PX / longer);
    probe.width_px = (uint32_t)fmax(1, round(scale * probe.width_px));
    probe.height_px = (uint32_t)fmax(1, round(scale * probe.height_px));
    probe.camera.projection = SHEEN_PROJECTION_PERSPECTIVE;
    probe.camera.fov_deg = ((struct sheen_request)SHEEN_REQUEST_DEFAULTS).camera.fov_deg;
    probe.camera.zoom = 0;
    probe.n_lights = 1;
    probe.lights[0] = (struct sheen_light){.pattern = SHEEN_PATTERN_DEFAULTS};
    probe.show = (struct sheen_show){0};
    probe.format = SHEEN_FORMAT_ZSTD;
    probe.jpeg_quality = 0;
    probe.jpeg_subsampling = SHEEN_JPEG_444;
    probe.request_class = stream->request.request_class;
    probe.deadline_ms = 0;
    enum sheen_status status =
        sheen_render(client->session, &probe, &client->report, &frame, &client->error);
    if (!status)
        status = sheen_query_model(client->session, client->model_id, &client->report, &info,
                                   &client->error);
    if (!status) {
        client_answered(client);
        place_camera(stream, options, &frame, &info);
    }
    sheen_frame_finish(&frame);
    return status;
}

/* Requests the first frame alone and without deadline: its answer tells the camera and the light
 * that then move. */
static enum sheen_status first_frame(struct client *client, struct stream *stream,
                                     const struct options *options)
{
    stream->request.deadline_ms = 0;
    enum sheen_status status = send_one(client, stream, 0);
    if (!status)
        status = receive_one(client, stream, options);
    if (status)
        return status;
    stream->request.deadline_ms = options->request.deadline_ms;
    progress_clear(&client->progress);
    if (!stream->has_camera) {
        stream->camera = stream->frame.camera;
        keep_axis(stream, &stream->frame);
    }
    stream->light = stream->frame.lights[0];
    /* The turntable's camera has the up that the daemon had chosen for the small frame. */
    stream->frame.up_source = stream->up_source;
    notices_ask(client, options, &stream->info);
    notices_print(client, options, &stream->frame, &stream->info);
    stream->records[0].stage_us[TABLES] += stream->tables_us;
    stream->start_us = clock_now_us();
    return SHEEN_OK;
}

static uint32_t n_answered(const struct stream *stream)
{
    return stream->n_drawn + stream->n_late;
}

enum sheen_status stream_frames(struct client *client, struct stream *stream,
                                const struct options *options)
{
    enum sheen_status status = client_upload_images(client, options, &stream->request);
    if (!status && !stream->has_camera && options->request.camera.auto_view && !options->light_only)
        status = find_camera(client, stream, options);
    if (!status && n_answered(stream) == 0)
        status = first_frame(client, stream, options);
    struct sheen_server server = SHEEN_SERVER_DEFAULTS;
    if (!status)
        status = sheen_get_server(client->session, &server, &client->error);
    uint32_t next = 0, n_in_flight = 0;
    uint32_t most = server.max_in_flight < IN_FLIGHT ? server.max_in_flight : IN_FLIGHT;
    while (!status && !interrupted && n_answered(stream) < options->frames) {
        while (next < options->frames && stream->records[next].state != WANTED)
            next++;
        if (next < options->frames && n_in_flight < most) {
            move(stream, options, next);
            status = send_one(client, stream, next++);
            n_in_flight++;
        } else {
            status = receive_one(client, stream, options);
            n_in_flight--;
            client->report.report(client->report.context, "frames", n_answered(stream),
                                  options->frames);
        }
    }
    stream->elapsed_us = clock_now_us() - stream->start_us;
    return status;
}
