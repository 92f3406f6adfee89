/* sheen stream: requests back to back while the camera or the light moves, and what each stage
 * took. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/base/clock.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/client.h"
#include "client/cli/notices.h"
#include "client/cli/options/lights_text.h"
#include "client/cli/base/failure.h"
#include "client/cli/turntable.h"
#include "client/cli/options/values.h"

/* The longer side of the small frame that is drawn only to learn the camera. */
#define PROBE_PX 64
#define IN_FLIGHT 2u    /* while a frame is transferred, the next request waits at the daemon */
#define LIGHT_SWING 0.1 /* largest shift of the light, as a share of its u edge */

/* The times of one frame. All are the daemon's, except the last: from request to decoded frame. */
enum stage { TABLES, VISIBILITY, EVALUATE, SHADE, READBACK, ENCODE, TOTAL, ROUND_TRIP, N_STAGES };
static const char *const STAGE_NAMES[N_STAGES] = {
    "tables", "visibility", "evaluate", "shade", "readback", "encode", "total", "round_trip"};

struct record {
    enum { WANTED, DRAWN, LATE } state;
    uint32_t number; /* number of the frame, from 0 */
    uint64_t stage_us[N_STAGES];
    uint64_t data_bytes;
};

/* A request that was sent. Answers may come in another order: a refusal before an older frame, or a
 * frame that was requested again after a newer one. */
struct sent {
    uint32_t frame;
    int64_t us;
};

struct stream {
    struct sheen_request request;   /* its camera and light move */
    bool has_camera;                /* the camera is known */
    struct sheen_camera camera;     /* camera of the first frame */
    double axis[3];                 /* axis of the turntable: the model's up */
    enum sheen_up_source up_source; /* where that up comes from */
    uint64_t tables_us;             /* time that the first frame would have waited for tables */
    struct sheen_light light;       /* the first light, which moves */
    struct sheen_frame frame;
    struct sheen_model_info info;
    struct record *records;   /* [frames], indexed by frame number */
    uint32_t n_drawn, n_late; /* frames received; frames that missed their deadline */
    uint64_t written_bytes;   /* size of all files written */
    /* Indexed by the request's number modulo the array's size. */
    struct sent sent[SHEEN_MAX_IN_FLIGHT];
    int64_t start_us, elapsed_us; /* without the first frame, which may wait for tables */
};

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

/* Requests all frames that have no answer yet. */
static enum sheen_status run_frames(struct client *client, struct stream *stream,
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
    while (!status && n_answered(stream) < options->frames) {
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

/* Moves the records of drawn frames to the front; keeps their order. */
static void keep_drawn(struct stream *stream, uint32_t n_frames)
{
    uint32_t n_kept = 0;
    for (uint32_t i = 0; i < n_frames; i++)
        if (stream->records[i].state == DRAWN)
            stream->records[n_kept++] = stream->records[i];
}

static double frames_per_second(const struct stream *stream, uint32_t n_frames)
{
    if (n_frames < 2)
        return 1e6 / (double)stream->records[0].stage_us[ROUND_TRIP];
    return (n_frames - 1) * 1e6 / (double)stream->elapsed_us;
}

static int compare_us(const void *a, const void *b)
{
    uint64_t left = *(const uint64_t *)a, right = *(const uint64_t *)b;
    return left < right ? -1 : left > right;
}

/* Prints the table of times. sorted[] is scratch memory for n_frames values. */
static void print_table(const struct stream *stream, uint32_t n_frames, uint64_t *sorted,
                        const struct options *options)
{
    const struct sheen_frame *frame = &stream->frame;
    printf("%u %s, %ux%u, %s\n", n_frames, value_noun(n_frames, "frame", "frames"), frame->width_px,
           frame->height_px, frame->device);
    printf("%-12s %10s %10s %10s   ms\n", "stage", "min", "median", "p95");
    for (int stage = 0; stage < N_STAGES; stage++) {
        for (uint32_t i = 0; i < n_frames; i++)
            sorted[i] = stream->records[i].stage_us[stage];
        qsort(sorted, n_frames, sizeof(*sorted), compare_us);
        uint32_t p95 = (uint32_t)(((uint64_t)n_frames * 95 + 99) / 100) - 1; /* nearest rank */
        printf("%-12s %10.2f %10.2f %10.2f\n", STAGE_NAMES[stage], (double)sorted[0] / 1e3,
               (double)sorted[(n_frames - 1) / 2] / 1e3, (double)sorted[p95] / 1e3);
    }
    printf("%.1f frames per second%s\n", frames_per_second(stream, n_frames),
           n_frames > 1 ? ", the first left out" : "");
    if (stream->request.show.range > 0)
        printf("colours of %s end at %.6g either way, in all frames\n",
               text_show_kind(stream->request.show.kind), stream->request.show.range);
    if (stream->n_late > 0)
        printf("%u more %s late\n", stream->n_late, value_noun(stream->n_late, "was", "were"));
    if (options->output)
        printf("%s: %u %s, %" PRIu64 " bytes\n", options->output, n_frames,
               value_noun(n_frames, "file", "files"), stream->written_bytes);
}

static void json_file(struct json *json, const struct options *options, uint32_t number)
{
    char *path = options->output ? frame_names_path(&options->frame_names, number) : NULL;
    if (path)
        json_string(json, "file", path);
    free(path);
}

static void print_json(struct json *json, const struct stream *stream, uint32_t n_frames,
                       const struct client *client, const struct options *options)
{
    const struct sheen_frame *frame = &stream->frame;
    json_object_begin(json, NULL);
    json_uint(json, "width", frame->width_px);
    json_uint(json, "height", frame->height_px);
    client_json_origin(json, client, options, frame);
    json_double(json, "frames_per_second", frames_per_second(stream, n_frames));
    json_uint(json, "late", stream->n_late);
    if (options->output) {
        json_string(json, "output", options->output);
        json_uint(json, "written", n_frames);
        json_uint(json, "written_bytes", stream->written_bytes);
    }
    client_json_schedule(json, &stream->request);
    if (stream->request.show.kind != SHEEN_SHOW_LINES)
        json_string(json, "show", text_show_kind(stream->request.show.kind));
    if (stream->request.show.range > 0)
        json_double(json, "show_range", stream->request.show.range);
    json_array_begin(json, "frames");
    for (uint32_t i = 0; i < n_frames; i++) {
        json_object_begin(json, NULL);
        json_uint(json, "number", stream->records[i].number);
        json_file(json, options, stream->records[i].number);
        for (int stage = 0; stage < N_STAGES; stage++) {
            char key[24];
            snprintf(key, sizeof(key), "%s_us", STAGE_NAMES[stage]);
            json_uint(json, key, stream->records[i].stage_us[stage]);
        }
        json_uint(json, "data_bytes", stream->records[i].data_bytes);
        json_object_end(json);
    }
    json_array_end(json);
    json_lines(json, "warnings", stream->info.warnings);
    json_object_end(json);
}

/* Checks before the work, by the name of the first file. */
static enum sheen_status check_writable(struct client *client, const struct options *options)
{
    if (!options->output)
        return SHEEN_OK;
    char *path = frame_names_path(&options->frame_names, 0);
    enum sheen_status status =
        path ? file_check_writable(path, &client->error)
             : failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for a file's name");
    free(path);
    return status;
}

static enum sheen_status run_command(struct client *client, struct stream *stream, uint64_t *sorted,
                                     const struct options *options)
{
    enum sheen_status status = check_writable(client, options);
    if (status)
        return status;
    status = client_init(client, options);
    if (!status)
        status = run_frames(client, stream, options);
    while (status && client_resume(client, options, &status))
        status = run_frames(client, stream, options);
    progress_clear(&client->progress);
    if (status)
        return status;
    keep_drawn(stream, options->frames);
    if (!options->json) {
        print_table(stream, stream->n_drawn, sorted, options);
        return SHEEN_OK;
    }
    struct json json = {.out = stdout};
    print_json(&json, stream, stream->n_drawn, client, options);
    return client_finish_json(client, &json);
}

static int run(const struct options *options)
{
    struct client client = {0};
    struct stream stream = {.request = options->request,
                            .frame = SHEEN_FRAME_DEFAULTS,
                            .info = SHEEN_MODEL_INFO_DEFAULTS};
    if (!options->output)
        stream.request.format = SHEEN_FORMAT_ZSTD;
    if (!(options->given & GIVEN_CLASS))
        stream.request.request_class = SHEEN_CLASS_INTERACTIVE;
    stream.records = calloc(options->frames, sizeof(*stream.records));
    uint64_t *sorted = calloc(options->frames, sizeof(*sorted));
    enum sheen_status status = stream.records && sorted
                                   ? run_command(&client, &stream, sorted, options)
                                   : failure_set(&client.error, SHEEN_NO_MEMORY,
                                                 "no memory for %u frames' times", options->frames);
    sheen_frame_finish(&stream.frame);
    free(sorted);
    free(stream.records);
    return client_finish(&client, status);
}

static bool apply_frames(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_FRAMES;
    return options_whole(&OPTION_RANGES[OPTION_RANGE_FRAMES], value, &options->frames, why);
}

static bool apply_output(struct options *options, const char *value, char *why)
{
    static const char example[] = "as FRAME_%04d.png";
    options->output = value;
    if (!frame_names_parse(value, &options->frame_names))
        return options_refuse(why,
                              "must have one %%d, or one like %%04d (a width of 1 to 9), in the "
                              "file's name and no other %%, %s",
                              example);
    return value_format(value, &options->request.format) ||
           options_refuse(why, "must end in .png .exr .jpg .jpeg .tif or .tiff, %s", example);
}

static bool apply_orbit(struct options *options, const char *value, char *why)
{
    return options_number(&OPTION_RANGES[OPTION_RANGE_ORBIT], value, &options->orbit_deg, why);
}

static bool apply_light_only(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    return options->light_only = true;
}

static bool check(struct options *options, char *why)
{
    if (!(options->given & GIVEN_FRAMES))
        return options_refuse(why, "--frames N is missing");
    return options_check_jpeg(options, why) && options_check_scene(options, why);
}

static const struct option_row ROWS[] = {
    {"frames", 'n', "N", "number of frames, {}", apply_frames, NULL},
    {"orbit", 0, "DEG",
     "angle that the camera turns for each frame, {}\n"
     "(default: 1), about the model's up direction. Without --eye it turns about the\n"
     "middle of the model's box, or about --target, at one distance from which the\n"
     "whole model stays in every picture; with --eye about --target, at the distance\n"
     "of the eye. --fov, --ortho and --zoom then magnify all frames alike",
     apply_orbit, NULL},
    {"output", 'o', "PATTERN",
     "write each frame to a file, such as FRAME_%04d.png: one %d, or one %04d (with\n"
     "a width from 1 to 9), stands for the frame's number, from 0; the ending tells\n"
     "the format: .png .exr .jpg .jpeg .tif .tiff (default: request lossless planes\n"
     "and drop them). A frame that missed its deadline has no file",
     apply_output, NULL},
    {"light-only", 0, NULL,
     "the light moves instead of the camera: it swings along its u edge by a tenth\n"
     "of that edge, once in 360 degrees of --orbit. Only the shading is repeated",
     apply_light_only, NULL},
    {0},
};

static const struct option_row *const TABLES_LIST[] = {ROWS, OPTIONS_OF_FRAMES, NULL};

const struct command COMMAND_STREAM = {
    .name = "stream",
    .arguments = "MODEL --frames N [option]...",
    .summary = "Requests frames back to back, at most two in flight, and prints the time of each\n"
               "stage; with -o writes the frames to files, as a turntable.",
    .tables = TABLES_LIST,
    .examples = "  sheen stream hood.obj --frames 100\n"
                "  sheen stream hood.obj --frames 72 --orbit 5 -o hood_%04d.png\n"
                "  sheen stream hood.obj --frames 100 --light-only --size 1920x1080\n"
                "  sheen stream hood.obj --frames 100 --class batch --deadline 500\n"
                "  sheen stream hood.obj --frames 360 --server unix:/run/sheen/sheen.sock --json\n",
    .takes_model = true,
    .check = check,
    .codes = CODE_FILES | CODE_SERVER,
    .run = run,
};
