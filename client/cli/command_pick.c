/* sheen pick: the numbers of the surface at a pixel of a picture, or along a line in it.
 *
 * A frame of one pixel, a part of the picture, has these numbers bit by bit as the planes of the
 * whole picture have them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/base/failure.h"
#include "client/cli/client.h"
#include "client/cli/commands.h"
#include "client/cli/notices.h"
#include "client/cli/options/values.h"
#include "client/cli/output/pick.h"
#include "client/cli/output/scene_json.h"

enum {
    POSITION_BIT = 1,
    NORMAL_BIT = 2,
    PTEX_BIT = 3,
    LIGHT_BIT = 4,
    CURVATURE_BIT = 5,
};
#define PICK_PLANES                                                                                \
    (SHEEN_PLANE_POSITION | SHEEN_PLANE_NORMAL | SHEEN_PLANE_PTEX | SHEEN_PLANE_LIGHT |            \
     SHEEN_PLANE_CURVATURE)

/* The picks in the order of their places, and which of them are answered. */
struct picks {
    size_t n;
    struct pick *pick;
    struct asked {
        uint32_t number; /* of the latest request */
        bool is_answered;
    } * asked;
    struct sheen_request request;
    struct sheen_frame frame; /* the latest */
};

static enum sheen_status send_pick(struct client *client, struct picks *picks, size_t i)
{
    picks->request.window.x_px = picks->pick[i].x;
    picks->request.window.y_px = picks->pick[i].y;
    enum sheen_status status = sheen_send(client->session, &picks->request, &client->error);
    picks->asked[i].number = sheen_last_number(client->session);
    return status;
}

static void take_planes(void *const *plane, struct pick *pick)
{
    memcpy(&pick->face, plane[PTEX_BIT], sizeof(pick->face));
    memcpy(pick->uv, (const char *)plane[PTEX_BIT] + sizeof(pick->face), sizeof(pick->uv));
    memcpy(pick->point, plane[POSITION_BIT], sizeof(pick->point));
    memcpy(pick->normal, plane[NORMAL_BIT], sizeof(pick->normal));
    memcpy(pick->curvature, plane[CURVATURE_BIT], sizeof(pick->curvature));
    memcpy(pick->light, plane[LIGHT_BIT], sizeof(pick->light));
}

/* Receives an answer. They come in the order of the requests, but for those that libsheen has sent
 * again because the daemon lost its GPU. */
static enum sheen_status receive_pick(struct client *client, struct picks *picks)
{
    enum sheen_status status =
        sheen_receive(client->session, &client->report, &picks->frame, &client->error);
    if (status)
        return status;
    size_t i = 0;
    while (i < picks->n &&
           (picks->asked[i].is_answered || picks->asked[i].number != picks->frame.number))
        i++;
    if (i == picks->n)
        return failure_set(&client->error, SHEEN_BAD_PEER, "an answer to no pick");
    take_planes(picks->frame.plane, &picks->pick[i]);
    picks->asked[i].is_answered = true;
    client_answered(client);
    return SHEEN_OK;
}

/* Asks for all picks without an answer, as many at once as the daemon allows. */
static enum sheen_status ask(struct client *client, const struct options *options,
                             struct picks *picks)
{
    struct sheen_server server = SHEEN_SERVER_DEFAULTS;
    enum sheen_status status = client_upload_images(client, options, &picks->request);
    if (!status)
        status = sheen_get_server(client->session, &server, &client->error);
    uint32_t in_flight = 0;
    for (size_t i = 0; !status && i < picks->n; i++) {
        if (picks->asked[i].is_answered)
            continue;
        if (in_flight == server.max_in_flight) {
            status = receive_pick(client, picks);
            in_flight--;
        }
        if (!status)
            status = send_pick(client, picks, i);
        in_flight++;
    }
    for (; !status && in_flight > 0; in_flight--)
        status = receive_pick(client, picks);
    return status;
}

static void print_json(struct json *json, const struct options *options,
                       const struct client *client, const struct picks *picks)
{
    json_object_begin(json, NULL);
    if (options->has_section) {
        json_array_begin(json, "samples");
        for (size_t i = 0; i < picks->n; i++) {
            json_object_begin(json, NULL);
            pick_json(json, &picks->pick[i]);
            json_object_end(json);
        }
        json_array_end(json);
    } else {
        pick_json(json, &picks->pick[0]);
    }
    json_uint(json, "width", options->request.width_px);
    json_uint(json, "height", options->request.height_px);
    client_json_origin(json, client, options, &picks->frame);
    json_text(json, "model", options->model);
    scene_json(json, &picks->request, &picks->frame);
    json_object_end(json);
}

static enum sheen_status print(struct client *client, const struct options *options,
                               const struct picks *picks)
{
    if (options->json) {
        struct json json = {.out = stdout};
        print_json(&json, options, client, picks);
        return client_finish_json(client, &json);
    }
    if (options->has_section)
        pick_print_csv(picks->pick, picks->n);
    else
        pick_print_table(&picks->pick[0]);
    return SHEEN_OK;
}

/* Sets the places: the pixel, or places at equal distances from the first to the last of the
 * section. */
static void set_places(struct picks *picks, const double at[static 4])
{
    size_t last = picks->n - 1;
    for (size_t i = 0; i < last; i++) {
        picks->pick[i].x = at[0] + (at[2] - at[0]) * (double)i / (double)last;
        picks->pick[i].y = at[1] + (at[3] - at[1]) * (double)i / (double)last;
    }
    picks->pick[last].x = at[2];
    picks->pick[last].y = at[3];
}

static int run(const struct options *options)
{
    struct client client = {0};
    struct picks picks = {.n = options->has_section ? options->samples : 1,
                          .request = options->request,
                          .frame = SHEEN_FRAME_DEFAULTS};
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    picks.request.window.width_px = options->request.width_px;
    picks.request.window.height_px = options->request.height_px;
    picks.request.width_px = picks.request.height_px = 1;
    picks.request.planes = PICK_PLANES;
    picks.request.format = SHEEN_FORMAT_RAW;
    picks.pick = calloc(picks.n, sizeof(*picks.pick));
    picks.asked = calloc(picks.n, sizeof(*picks.asked));
    enum sheen_status status = SHEEN_OK;
    if (picks.pick && picks.asked)
        set_places(&picks, options->at);
    else
        status = failure_set(&client.error, SHEEN_NO_MEMORY, "no memory for %zu samples", picks.n);
    if (!status)
        status = client_init(&client, options);
    if (!status)
        status = ask(&client, options, &picks);
    while (status && client_resume(&client, options, &status))
        status = ask(&client, options, &picks);
    progress_clear(&client.progress);
    if (!status)
        status = print(&client, options, &picks);
    if (!status)
        notices_ask(&client, options, &info);
    if (!status)
        notices_print_model(&client, options, &picks.frame, &info);
    sheen_frame_finish(&picks.frame);
    free(picks.asked);
    free(picks.pick);
    return client_finish(&client, status);
}

static bool apply_section(struct options *options, const char *value, char *why)
{
    options->has_section = true;
    return value_numbers(value, options->at, 4) ||
           options_refuse(why, "must be four numbers X0,Y0,X1,Y1");
}

static bool apply_samples(struct options *options, const char *value, char *why)
{
    options->given |= GIVEN_SAMPLES;
    return options_whole(&OPTION_RANGES[OPTION_RANGE_SAMPLES], value, &options->samples, why);
}

static bool check_inside(const struct options *options, double x, double y, char *why)
{
    const struct sheen_request *request = &options->request;
    return (x >= 0 && y >= 0 && x < request->width_px && y < request->height_px) ||
           options_refuse(why,
                          "%.9g,%.9g is not in the picture, whose pixels are 0,0 to %u,%u (--size)",
                          x, y, request->width_px - 1, request->height_px - 1);
}

static bool check(struct options *options, char *why)
{
    if (options->has_section && options->argument)
        return options_refuse(why, "X,Y and --section exclude each other");
    if (!options->has_section && options->given & GIVEN_SAMPLES)
        return options_refuse(why, "--samples is for --section");
    if (!options->has_section) {
        if (!options->argument)
            return options_refuse(why, "a pixel X,Y or --section is missing");
        if (!value_numbers(options->argument, options->at, 2))
            return options_refuse(why, "'%.60s': a pixel is two numbers X,Y", options->argument);
        options->at[2] = options->at[0];
        options->at[3] = options->at[1];
    }
    if (!(options->given & GIVEN_SAMPLES))
        options->samples = 100;
    return check_inside(options, options->at[0], options->at[1], why) &&
           check_inside(options, options->at[2], options->at[3], why) &&
           options_check_scene(options, why);
}

static const struct option_row ROWS[] = {
    {"section", 0, "X0,Y0,X1,Y1",
     "instead of one pixel, places along a line of the picture, both ends included;\n"
     "prints a line of CSV for each, with empty fields where there is no number",
     apply_section, NULL},
    {"samples", 0, "N", "number of places of --section, {client} (default: 100)", apply_samples,
     NULL},
    {0},
};

static const struct option_row *const TABLES[] = {
    ROWS,           OPTIONS_SIZE,      OPTIONS_SCENE,  OPTIONS_MODEL,
    OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_PICK = {
    .name = "pick",
    .arguments = "MODEL X,Y [option]...",
    .summary =
        "Prints the numbers of the surface at a pixel of the picture that the other options\n"
        "describe: point, normal, principal curvatures, smallest radius of curvature, Ptex face\n"
        "with u and v, and the place s, t on the light. 0,0 is the top left pixel; fractions lie\n"
        "between the centres of pixels. The numbers are those of the planes of 'sheen render'.",
    .tables = TABLES,
    .examples = "  sheen pick hood.obj 640,360\n"
                "  sheen pick hood.obj 120.5,80 --size 320x200 --view left --json\n"
                "  sheen pick hood.obj --section 0,360,1279,360 --samples 200 > section.csv\n",
    .takes_model = true,
    .takes_argument = true,
    .check = check,
    .codes = CODE_FILES | CODE_SERVER,
    .run = run,
};
