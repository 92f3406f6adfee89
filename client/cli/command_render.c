/* sheen render: one frame of a model into a file. */
#include <inttypes.h>
#include <stdio.h>

#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/client.h"
#include "client/cli/notices.h"
#include "client/cli/output/scene_json.h"
#include "client/cli/options/values.h"

static bool apply_output(struct options *options, const char *value, char *why)
{
    options->output = value;
    return value_format(value, &options->request.format) ||
           options_refuse(why, "must end in .png .exr .jpg .jpeg .tif or .tiff");
}

static bool apply_aov(struct options *options, const char *value, char *why)
{
    return value_planes(value, &options->aov_planes) ||
           options_refuse(why, "must be some of P,N,ptex,light,k,dlight,coverage");
}

static bool check(struct options *options, char *why)
{
    if (!options->output)
        return options_refuse(why, "-o FILE is missing");
    if (options->aov_planes && options->request.format != SHEEN_FORMAT_EXR)
        return options_refuse(why, "--aov needs an output that ends in .exr");
    options->request.planes |= options->aov_planes;
    return options_check_jpeg(options, why) && options_check_scene(options, why);
}

static void print_json(struct json *json, const struct options *options,
                       const struct client *client, const struct sheen_frame *frame,
                       const struct sheen_model_info *info)
{
    json_object_begin(json, NULL);
    json_text(json, "file", options->output);
    json_uint(json, "file_bytes", frame->data_bytes);
    json_uint(json, "width", frame->width_px);
    json_uint(json, "height", frame->height_px);
    client_json_origin(json, client, options, frame);
    json_text(json, "address", options->server ? options->server : "private");
    json_text(json, "model", options->model);
    if (info->faces)
        json_uint(json, "faces", info->faces);
    if (options->request.jpeg_quality)
        json_uint(json, "jpeg_quality", options->request.jpeg_quality);
    if (options->request.format == SHEEN_FORMAT_JPEG)
        json_text(json, "jpeg_subsampling",
                  value_subsampling_name(options->request.jpeg_subsampling));
    json_bool(json, "blank", frame->blank);
    client_json_times(json, &frame->times);
    client_json_schedule(json, &options->request);
    scene_json(json, &options->request, frame);
    json_lines(json, "warnings", info->warnings);
    json_object_end(json);
}

static void print_summary(const struct options *options, const struct sheen_frame *frame,
                          const struct sheen_model_info *info)
{
    fprintf(stderr, "%s: %" PRIu32 "x%" PRIu32 ", ", options->output, frame->width_px,
            frame->height_px);
    if (info->faces)
        fprintf(stderr, "%" PRIu32 " %s, ", info->faces, value_noun(info->faces, "face", "faces"));
    fprintf(stderr, "%s, %.0f ms\n", frame->device, (double)frame->times.total_us / 1e3);
}

static int run(const struct options *options)
{
    struct client client = {0};
    struct sheen_request request = options->request;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    enum sheen_status status = file_check_writable(options->output, &client.error);
    if (status)
        return client_finish(&client, status);
    status = client_init(&client, options);
    if (!status)
        status = client_render(&client, options, &request, &frame);
    if (!status)
        status = file_write(options->output, frame.data, frame.data_bytes, &client.error);
    /* Asked after the frame, so that the frame's times include the tables that it had to wait
     * for. */
    if (!status)
        notices_ask(&client, options, &info);
    if (!status)
        notices_print(&client, options, &frame, &info);
    if (!status && !options->quiet)
        print_summary(options, &frame, &info);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, options, &client, &frame, &info);
        status = client_finish_json(&client, &json);
    }
    sheen_frame_finish(&frame);
    return client_finish(&client, status);
}

static const struct option_row ROWS[] = {
    {"output", 'o', "FILE",
     "file of the picture; its ending tells the format: .png .exr .jpg .jpeg .tif\n"
     ".tiff",
     apply_output, NULL},
    {"aov", 0, "LIST",
     "planes in addition to colour, for EXR files, separated by commas: P\n"
     "(position), N (normal), ptex, light (s, t on the light), k (principal\n"
     "curvatures), dlight (change of s, t per pixel to the right and down), coverage\n"
     "(share of the pixel that shows the surface)",
     apply_aov, "P N ptex light k dlight coverage"},
    {0},
};

static const struct option_row *const TABLES[] = {ROWS, OPTIONS_OF_FRAMES, NULL};

const struct command COMMAND_RENDER = {
    .name = "render",
    .arguments = "MODEL -o FILE [option]...",
    .summary =
        "Renders the reflection lines on a model's limit surface, exact at every pixel.\n"
        "MODEL is a control cage: OBJ, USD as text (.usda), GLB, or glTF together with the buffer\n"
        "files that it names; or patches: .bpt, .patches, or the free-form surfaces of an OBJ "
        "file.",
    .tables = TABLES,
    .examples =
        "  sheen render hood.obj -o hood.png\n"
        "  sheen render hood.glb -o hood.png --size 1920x1080 --eye 3,-4,2 --target 0,0,0.5\n"
        "  sheen render hood.glb -o hood.png --pattern stripes:count=40,duty=0.3,bg=#202020\n"
        "  sheen render hood.obj -o hood.jpg --jpeg-quality 80 --jpeg-subsampling 420\n"
        "  sheen render hood.obj -o hood.exr --aov P,N,ptex --json\n"
        "  sheen render hood.obj -o hood.png --server tls:render1:7410 --ca ours.pem "
        "--token-file token\n",
    .takes_model = true,
    .check = check,
    .codes = CODE_FILES | CODE_SERVER | CODE_LATE,
    .run = run,
};
