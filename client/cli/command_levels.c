/* sheen levels: the paper's comparison (Yasui and Kanai 2004, figure 7) of one model: wireframe,
 * polygons and the exact surface side by side, and how far the polygons' normals are off. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "client/cli/output/canvas.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/output/glyphs.h"
#include "client/cli/client.h"
#include "client/cli/notices.h"
#include "client/cli/base/failure.h"
#include "client/cli/options/values.h"

enum { FIRST_LEVEL = 1, LAST_LEVEL = 3, N_LEVELS = LAST_LEVEL - FIRST_LEVEL + 1 };
enum { WIREFRAME, POLYGON, EXACT, N_COLUMNS };
enum { N_LINES = 3, CAPTION_BYTES = 64 }; /* of a caption */

/* The largest and the mean angle between a polygon's normal and the surface's, where one pixel
 * shows both on the same Ptex face. */
struct normal_error {
    double max_deg, mean_deg; /* NaN when there is no such pixel */
    uint64_t pixels;
};

struct figure {
    struct canvas canvas;
    uint32_t panel_width, panel_height, gap;
    uint32_t scale, line; /* captions: size of a letter's pixel, and distance of lines, px */
    struct normal_error errors[N_LEVELS];
};

static bool apply_output(struct options *options, const char *value, char *why)
{
    options->output = value;
    return (value_format(value, &options->request.format) &&
            options->request.format == SHEEN_FORMAT_PNG) ||
           options_refuse(why, "must end in .png");
}

static bool check(struct options *options, char *why)
{
    struct sheen_request *request = &options->request;
    if (!options->output)
        return options_refuse(why, "-o FILE is missing");
    if (!(options->given & GIVEN_SIZE)) {
        request->width_px = 480;
        request->height_px = 360;
    }
    request->format = SHEEN_FORMAT_ZSTD;
    request->planes = SHEEN_PLANE_COLOUR | SHEEN_PLANE_NORMAL | SHEEN_PLANE_PTEX;
    return options_check_scene(options, why);
}

static double angle_deg(const float a[3], const float b[3])
{
    const double x[3] = {a[0], a[1], a[2]}, y[3] = {b[0], b[1], b[2]};
    const double cross[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2],
                             x[0] * y[1] - x[1] * y[0]};
    double dot = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    return atan2(sine, dot) * (180 / 3.14159265358979323846);
}

static struct normal_error compare(const struct sheen_frame *polygon,
                                   const struct sheen_frame *exact)
{
    enum { NORMAL_BIT = 2, PTEX_BIT = 3 };
    const float(*a)[3] = polygon->plane[NORMAL_BIT], (*b)[3] = exact->plane[NORMAL_BIT];
    const uint32_t(*face_a)[3] = polygon->plane[PTEX_BIT], (*face_b)[3] = exact->plane[PTEX_BIT];
    struct normal_error error = {.max_deg = NAN};
    double sum = 0;
    for (size_t k = 0; k < (size_t)exact->width_px * exact->height_px; k++) {
        double deg = face_a[k][0] == face_b[k][0] ? angle_deg(a[k], b[k]) : NAN;
        if (isnan(deg)) /* no surface, or no normal */
            continue;
        error.max_deg = fmax(error.max_deg, deg);
        sum += deg;
        error.pixels++;
    }
    error.mean_deg = sum / (double)error.pixels;
    return error;
}

static bool figure_init(struct figure *figure, const struct sheen_request *request)
{
    const uint32_t letters = 28; /* length of the longest caption */
    uint32_t scale = request->width_px / (letters * GLYPH_ADVANCE);
    figure->panel_width = request->width_px;
    figure->panel_height = request->height_px;
    figure->scale = scale > 0 ? scale : 1;
    figure->line = figure->scale * (GLYPH_HEIGHT + 2);
    figure->gap = 6 * figure->scale;
    uint64_t width = (uint64_t)N_COLUMNS * (figure->panel_width + figure->gap) + figure->gap;
    uint64_t height =
        (uint64_t)N_LEVELS * (figure->panel_height + N_LINES * figure->line + 2 * figure->gap);
    return width <= INT32_MAX / 3 && height <= INT32_MAX &&
           canvas_init(&figure->canvas, (uint32_t)width, (uint32_t)height + figure->gap);
}

/* Places a panel at its column and level, with lines of text below. */
static void place(struct figure *figure, int column, int row, const struct sheen_frame *frame,
                  const char *const caption[N_LINES])
{
    uint32_t x = figure->gap + (uint32_t)column * (figure->panel_width + figure->gap);
    uint32_t y = figure->gap +
                 (uint32_t)row * (figure->panel_height + N_LINES * figure->line + 2 * figure->gap);
    uint32_t below = y + figure->panel_height + figure->gap / 2, end = x + figure->panel_width;
    canvas_picture(&figure->canvas, x, y, frame->plane[0], frame->width_px, frame->height_px);
    for (uint32_t k = 0; k < N_LINES; k++)
        canvas_text(&figure->canvas, x, below + k * figure->line, end, figure->scale, caption[k]);
}

/* Writes the two lines below the title. */
static void describe(const struct normal_error *error, char largest[CAPTION_BYTES],
                     char mean[CAPTION_BYTES])
{
    snprintf(largest, CAPTION_BYTES, "normals up to %.3g deg off,", error->max_deg);
    snprintf(mean, CAPTION_BYTES, "%.3g on average", error->mean_deg);
    if (!error->pixels) {
        snprintf(largest, CAPTION_BYTES, "nothing to compare");
        *mean = 0;
    }
}

static enum sheen_status render(struct client *client, const struct options *options,
                                struct sheen_request *request, enum sheen_surface surface,
                                int level, struct sheen_frame *frame)
{
    request->surface = surface;
    request->surface_level = (uint32_t)level;
    return client_render(client, options, request, frame);
}

static enum sheen_status draw_row(struct client *client, const struct options *options,
                                  struct sheen_request *request, int row,
                                  const struct sheen_frame *exact, struct sheen_frame *frame,
                                  struct figure *figure)
{
    char title[CAPTION_BYTES], largest[CAPTION_BYTES], mean[CAPTION_BYTES];
    int level = FIRST_LEVEL + row;
    enum sheen_status status =
        render(client, options, request, SHEEN_SURFACE_WIREFRAME, level, frame);
    if (status)
        return status;
    snprintf(title, sizeof(title), "wireframe, level %d", level);
    place(figure, WIREFRAME, row, frame, (const char *[]){title, "", ""});
    status = render(client, options, request, SHEEN_SURFACE_POLYGON, level, frame);
    if (status)
        return status;
    figure->errors[row] = compare(frame, exact);
    snprintf(title, sizeof(title), "polygon, level %d:", level);
    describe(&figure->errors[row], largest, mean);
    place(figure, POLYGON, row, frame, (const char *[]){title, largest, mean});
    place(figure, EXACT, row, exact, (const char *[]){"exact", "", ""});
    return SHEEN_OK;
}

static enum sheen_status draw(struct client *client, const struct options *options,
                              struct sheen_frame *exact, struct figure *figure)
{
    struct sheen_request request = options->request;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    enum sheen_status status = render(client, options, &request, SHEEN_SURFACE_EXACT, 0, exact);
    if (!status && !figure_init(figure, &request))
        status =
            failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for nine panels of that size");
    for (int row = 0; row < N_LEVELS && !status; row++)
        status = draw_row(client, options, &request, row, exact, &frame, figure);
    sheen_frame_finish(&frame);
    return status ? status : canvas_write_png(&figure->canvas, options->output, &client->error);
}

static void print_text(const struct figure *figure)
{
    for (int row = 0; row < N_LEVELS; row++) {
        const struct normal_error *error = &figure->errors[row];
        char largest[CAPTION_BYTES], mean[CAPTION_BYTES];
        describe(error, largest, mean);
        printf("level %d: %s %s (%" PRIu64 " pixels)\n", FIRST_LEVEL + row, largest, mean,
               error->pixels);
    }
}

static void print_json(struct json *json, const struct options *options,
                       const struct client *client, const struct sheen_frame *exact,
                       const struct sheen_model_info *info, const struct figure *figure)
{
    json_object_begin(json, NULL);
    json_text(json, "file", options->output);
    json_uint(json, "width", figure->canvas.width_px);
    json_uint(json, "height", figure->canvas.height_px);
    client_json_origin(json, client, options, exact);
    json_text(json, "model", options->model);
    json_array_begin(json, "levels");
    for (int row = 0; row < N_LEVELS; row++) {
        json_object_begin(json, NULL);
        json_uint(json, "level", (uint64_t)(FIRST_LEVEL + row));
        json_double(json, "max_deg", figure->errors[row].max_deg);
        json_double(json, "mean_deg", figure->errors[row].mean_deg);
        json_uint(json, "pixels", figure->errors[row].pixels);
        json_object_end(json);
    }
    json_array_end(json);
    json_lines(json, "warnings", info->warnings);
    json_object_end(json);
}

static int run(const struct options *options)
{
    struct client client = {0};
    struct sheen_frame exact = SHEEN_FRAME_DEFAULTS;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    struct figure figure = {0};
    enum sheen_status status = file_check_writable(options->output, &client.error);
    if (status)
        return client_finish(&client, status);
    status = client_init(&client, options);
    if (!status)
        status = draw(&client, options, &exact, &figure);
    progress_clear(&client.progress);
    if (!status) {
        notices_ask(&client, options, &info);
        notices_print(&client, options, &exact, &info);
    }
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, options, &client, &exact, &info, &figure);
        status = client_finish_json(&client, &json);
    } else if (!status) {
        print_text(&figure);
    }
    canvas_finish(&figure.canvas);
    sheen_frame_finish(&exact);
    return client_finish(&client, status);
}

static const struct option_row ROWS[] = {
    {"output", 'o', "FILE",
     "file of the picture: a PNG with three rows and three columns of panels", apply_output, NULL},
    {"size", 0, "WxH",
     "width and height of one panel (default: 480x360),\n"
     "each {}; the device's limit may be lower",
     options_apply_size, NULL},
    {0},
};

static const struct option_row *const TABLES[] = {
    ROWS, OPTIONS_SCENE, OPTIONS_MODEL, OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_LEVELS = {
    .name = "levels",
    .old_name = "figure7",
    .arguments = "MODEL -o FILE.png [option]...",
    .summary =
        "Shows what polygons do to reflection lines: the cage subdivided 1, 2 and 3 times, as a\n"
        "wireframe and as interpolated polygons, beside the exact surface. Prints the largest and\n"
        "the mean angle between the polygons' normals and those of the surface, over the pixels\n"
        "that show both on the same face.",
    .tables = TABLES,
    .examples = "  sheen levels hood.obj -o levels.png\n"
                "  sheen levels hood.glb -o levels.png --size 800x600 --pattern stripes:count=80\n",
    .takes_model = true,
    .check = check,
    .codes = CODE_FILES | CODE_SERVER,
    .run = run,
};
