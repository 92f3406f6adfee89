/* sheen stream: its options, and the order of its work. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

#include "client/cli/base/failure.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/options/values.h"
#include "client/cli/stream/report.h"

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
        status = stream_frames(client, stream, options);
    while (status && !stream_is_interrupted() && client_resume(client, options, &status))
        status = stream_frames(client, stream, options);
    progress_clear(&client->progress);
    /* An interrupt ends the command's own daemon, too. What was drawn before is printed. */
    if (stream_is_interrupted())
        status = SHEEN_OK;
    if (status || stream->n_drawn == 0)
        return status;
    stream_keep_drawn(stream, options->frames);
    if (!options->json) {
        stream_print_table(stream, stream->n_drawn, sorted, options);
        return SHEEN_OK;
    }
    struct json json = {.out = stdout};
    stream_print_json(&json, stream, stream->n_drawn, client, options);
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
    stream_end_at_interrupt();
    stream.records = calloc(options->frames, sizeof(*stream.records));
    uint64_t *sorted = calloc(options->frames, sizeof(*sorted));
    enum sheen_status status = stream.records && sorted
                                   ? run_command(&client, &stream, sorted, options)
                                   : failure_set(&client.error, SHEEN_NO_MEMORY,
                                                 "no memory for %u frames' times", options->frames);
    sheen_frame_finish(&stream.frame);
    free(sorted);
    free(stream.records);
    const int code = client_finish(&client, status);
    if (stream_is_interrupted()) { /* ends as every interrupted command does */
        fflush(stdout);
        signal(SIGINT, SIG_DFL);
        raise(SIGINT);
    }
    return code;
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
               "stage, also of those before Ctrl-C; with -o writes the frames to files, as a\n"
               "turntable.",
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
