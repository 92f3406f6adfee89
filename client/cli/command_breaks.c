/* sheen breaks: where the lines of a surface break, and by how much. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/base/failure.h"
#include "client/cli/client.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/options/values.h"
#include "client/cli/output/breaks_picture.h"
#include "client/cli/output/breaks_report.h"

enum { OUT_OF_TOLERANCE = 1 }; /* exit code */

static enum sheen_status write_junit(struct client *client, const struct options *options,
                                     const struct sheen_breaks *breaks)
{
    size_t n_bytes = 0;
    char *text = breaks_junit(options, breaks, &n_bytes);
    enum sheen_status status =
        text ? file_write(options->junit, (const uint8_t *)text, n_bytes, &client->error)
             : failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for the report");
    free(text);
    return status;
}

static enum sheen_status write_picture(struct client *client, const struct options *options,
                                       const struct sheen_breaks *breaks, uint32_t *n_hidden)
{
    struct sheen_request request = options->request;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct canvas canvas = {.width_px = 0};
    request.format = SHEEN_FORMAT_ZSTD;
    request.planes = BREAKS_PICTURE_PLANES;
    enum sheen_status status = client_render(client, options, &request, &frame);
    if (!status && !breaks_picture(&canvas, &frame, breaks, n_hidden))
        status = failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for the picture");
    if (!status)
        status = canvas_write_png(&canvas, options->output, &client->error);
    canvas_finish(&canvas);
    sheen_frame_finish(&frame);
    return status;
}

static enum sheen_status ask(struct client *client, const struct options *options,
                             struct sheen_breaks *breaks)
{
    struct sheen_request request = options->request;
    enum sheen_status status;
    do {
        memcpy(request.model_id, client->model_id, SHEEN_ID_BYTES);
        status = sheen_find_breaks(client->session, &request, &options->break_limits,
                                   &client->report, breaks, &client->error);
    } while (status && client_resume(client, options, &status));
    if (status == SHEEN_LATE && request.deadline_ms)
        failure_set(&client->error, status,
                    "the breaks were not found within --deadline %u (milliseconds): give it more "
                    "time, or ask again when the daemon has less to do",
                    request.deadline_ms);
    return status;
}

static enum sheen_status print(struct client *client, const struct options *options,
                               const struct sheen_breaks *breaks)
{
    enum sheen_status status = SHEEN_OK;
    uint32_t n_hidden = 0;
    if (options->junit)
        status = write_junit(client, options, breaks);
    if (!status && options->output)
        status = write_picture(client, options, breaks, &n_hidden);
    progress_clear(&client->progress);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        breaks_json(&json, options, client->model_id, breaks);
        status = client_finish_json(client, &json);
    } else if (!status) {
        breaks_table(options, breaks);
    }
    if (!status && n_hidden > 0 && !options->quiet)
        fprintf(stderr, "sheen: %s: %u of %u edges out of tolerance cannot be seen in this view\n",
                options->output, n_hidden, breaks->n_out);
    return status;
}

static int run(const struct options *options)
{
    struct client client = {.session = NULL};
    struct sheen_breaks breaks = SHEEN_BREAKS_DEFAULTS;
    enum sheen_status status =
        options->junit ? file_check_writable(options->junit, &client.error) : SHEEN_OK;
    if (!status && options->output)
        status = file_check_writable(options->output, &client.error);
    if (status)
        return client_finish(&client, status);
    status = client_init(&client, options);
    if (!status)
        status = ask(&client, options, &breaks);
    if (!status)
        status = print(&client, options, &breaks);
    bool is_out = !status && breaks.n_out > 0;
    sheen_breaks_finish(&breaks);
    int code = client_finish(&client, status);
    return is_out ? OUT_OF_TOLERANCE : code;
}

static bool apply_angle(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_ANGLE], value, &options->break_limits.angle_deg, why);
}

static bool apply_gap(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_GAP], value, &options->break_limits.gap, why);
}

static bool apply_curvature(struct options *options, const char *value, char *why)
{
    return options_number(&RANGES[RANGE_PERCENT], value, &options->break_limits.curvature_percent,
                          why);
}

static bool apply_output(struct options *options, const char *value, char *why)
{
    enum sheen_format format;
    options->output = value;
    return (value_format(value, &format) && format == SHEEN_FORMAT_PNG) ||
           options_refuse(why, "must end in .png");
}

static bool apply_junit(struct options *options, const char *value, char *why)
{
    options->junit = value;
    return *value || options_refuse(why, "must be a file");
}

static const struct option_row ROWS[] = {
    {"angle", 0, "DEG",
     "largest angle between the normals of both sides of an edge,\n"
     "{} (default: 0.1)",
     apply_angle, NULL},
    {"gap", 0, "LENGTH",
     "largest distance of both sides of an edge, {}\n"
     "of the model (default: 1e-5 of the diagonal of the model's box). Border edges\n"
     "count as joined within 10 times this distance or 1e-3 of the diagonal, whichever\n"
     "is larger (1e-4 for two skins of a part, whose faces lie on the same side)",
     apply_gap, NULL},
    {"curvature", 0, "PERCENT",
     "largest jump of the curvature across an edge, {},\n"
     "of the mean of both sides (default: 10)",
     apply_curvature, NULL},
    {"output", 'o', "FILE",
     "write a picture of the lines (.png) with the edges out of tolerance painted:\n"
     "magenta, a gap; red, an angle; orange, the curvature",
     apply_output, NULL},
    {"junit", 0, "FILE", "write a JUnit report, with a test case for each limit", apply_junit,
     NULL},
    {0},
};

static const struct option_row *const TABLES[] = {
    ROWS,           OPTIONS_DEADLINE,  OPTIONS_SIZE,   OPTIONS_SCENE, OPTIONS_MODEL,
    OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_BREAKS = {
    .name = "breaks",
    .arguments = "MODEL [option]...",
    .summary =
        "Finds where the lines of a surface break, along creases and joints, and by how much:\n"
        "gap, angle, jump of the curvature, kink and jump of the lines, at the worst place of\n"
        "each edge, the worst edge first. Camera, lights and lines decide kinks and jumps alone.",
    .tables = TABLES,
    .examples =
        "  sheen breaks hood.obj\n"
        "  sheen breaks hood.obj --angle 0.05 --gap 0.01 --curvature 5\n"
        "  sheen breaks hood.obj -o breaks.png --view front\n"
        "  sheen breaks hood.obj --json --junit breaks.xml > breaks.json\n"
        "  sheen breaks hood.obj --lines highlight --light plane --pattern stripes:period=5\n",
    .takes_model = true,
    .check = options_check_scene,
    .codes = CODE_FILES | CODE_SERVER | CODE_LATE,
    .no = "an edge is out of tolerance",
    .run = run,
};
