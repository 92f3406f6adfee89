#include "client/cli/compare/report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "client/cli/base/failure.h"
#include "client/cli/files/file.h"
#include "client/cli/output/canvas.h"
#include "client/cli/output/heat_map.h"
#include "client/cli/turntable.h"

enum { N_VIEWS = 4, WIDTH_PX = 640, HEIGHT_PX = 360, SCALE_HEIGHT_PX = 16, PATH_BYTES = 4200 };
/* Maps end at so many times the limit. */
static const double MAP_LIMITS = 4;

static const char STYLE[] =
    "body { font: 15px/1.4 sans-serif; margin: 1.5em; color: #222; background: #fff }\n"
    "h1 { font-size: 1.4em } h2 { font-size: 1.2em; border-top: 1px solid #bbb; padding-top: .8em "
    "}\n"
    "table { border-collapse: collapse } td, th { padding: .2em .7em; border: 1px solid #ccc; "
    "text-align: right }\n"
    "td:first-child, th:first-child { text-align: left }\n"
    ".out { background: #fbd0d0; font-weight: bold } .same { color: #070 } .bad { color: #b00 }\n"
    "figure { display: inline-block; margin: .5em } figcaption { font-size: .85em }\n"
    "img { display: block; max-width: 100%; height: auto }\n"
    ".blink { position: relative } .blink .over { position: absolute; left: 0; top: 0; "
    "animation: blink 1.2s steps(1) infinite }\n"
    "@keyframes blink { 0% { opacity: 1 } 50% { opacity: 0 } }\n"
    "@media (prefers-reduced-motion: reduce) { .blink .over { animation: none } "
    ".blink:hover .over { opacity: 0 } }\n";

struct report {
    struct client *client;
    const struct options *options;
    const char *folder;
    FILE *page;
    struct sheen_frame frames[2]; /* old, new */
};

static void path_of(const struct report *report, char path[static PATH_BYTES], const char *name)
{
    snprintf(path, PATH_BYTES, "%s/%s", report->folder, name);
}

/* Text of HTML. Control characters, which HTML has not, become '?'. */
static void put_text(FILE *page, const char *text)
{
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\'')
            fprintf(page, "&#%d;", c);
        else
            fputc(c < 0x20 || c == 0x7f ? '?' : c, page);
    }
}

/* --- pictures */

static enum sheen_status render_one(struct report *report, const struct compared_pair *pair,
                                    int side, struct sheen_request *request)
{
    memcpy(report->client->model_id, pair->ids[side], SHEEN_ID_BYTES);
    return client_render(report->client, report->options, request, &report->frames[side]);
}

/* Fills in the camera, lines and lights that a small frame of the old model used, so that both models get the same. A
 * camera that the daemon chose is moved so far away that the model stays in the picture when it turns. */
static enum sheen_status settle_scene(struct report *report, const struct compared_pair *pair,
                                      struct sheen_request *request)
{
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    const struct sheen_frame *frame = &report->frames[0];
    bool is_chosen = request->camera.auto_view;
    enum sheen_status status = render_one(report, pair, 0, request);
    if (status)
        return status;
    request->camera = frame->camera;
    request->lines = frame->lines;
    request->n_lights = frame->n_lights;
    memcpy(request->lights, frame->lights, sizeof(request->lights));
    if (!is_chosen || frame->camera.projection != SHEEN_PROJECTION_PERSPECTIVE)
        return SHEEN_OK;
    status = sheen_query_model(report->client->session, pair->ids[0], &report->client->report,
                               &info, &report->client->error);
    if (!status)
        turntable_fit(&request->camera, frame->up, info.box_min, info.box_max,
                      (double)WIDTH_PX / HEIGHT_PX, NULL);
    return status;
}

static enum sheen_status write_picture(struct report *report, const struct canvas *canvas,
                                       const char *name)
{
    char path[PATH_BYTES];
    path_of(report, path, name);
    return canvas_write_png(canvas, path, &report->client->error);
}

/* Writes old, new, and both maps of a view: pP-vV-old.png and so on. */
static enum sheen_status write_view(struct report *report, const struct compared_pair *pair,
                                    size_t p, int view)
{
    static const char *const names[4] = {"old", "new", "angle", "distance"};
    const double *limits = pair->comparison.limits;
    struct canvas canvas;
    enum sheen_status status = SHEEN_OK;
    if (!canvas_init(&canvas, WIDTH_PX, HEIGHT_PX))
        return failure_set(&report->client->error, SHEEN_NO_MEMORY, "no memory for a picture");
    for (int k = 0; k < 4 && !status; k++) {
        char name[64];
        if (k < 2) {
            memset(canvas.rgb, 0xff, (size_t)3 * WIDTH_PX * HEIGHT_PX);
            canvas_picture(&canvas, 0, 0, report->frames[k].plane[0], WIDTH_PX, HEIGHT_PX);
        } else {
            heat_map_paint(&canvas, k == 2 ? HEAT_NORMAL : HEAT_DISTANCE, &report->frames[0],
                           &report->frames[1],
                           MAP_LIMITS *
                               limits[k == 2 ? SHEEN_COMPARE_NORMAL : SHEEN_COMPARE_DISTANCE]);
        }
        snprintf(name, sizeof(name), "p%zu-v%d-%s.png", p, view, names[k]);
        status = write_picture(report, &canvas, name);
    }
    canvas_finish(&canvas);
    return status;
}

static enum sheen_status write_scale(struct report *report)
{
    struct canvas canvas;
    if (!canvas_init(&canvas, WIDTH_PX / 2, SCALE_HEIGHT_PX))
        return failure_set(&report->client->error, SHEEN_NO_MEMORY, "no memory for a picture");
    heat_map_paint_scale(&canvas);
    enum sheen_status status = write_picture(report, &canvas, "scale.png");
    canvas_finish(&canvas);
    return status;
}

/* --- pages */

static void put_table(FILE *page, const struct compared_pair *pair)
{
    fputs("<table><tr><th></th><th>worst</th><th>limit</th><th>area beyond, "
          "%</th><th>where</th></tr>\n",
          page);
    for (int k = 0; k < COMPARISON_ITEMS; k++) {
        enum comparison_item item = (enum comparison_item)k;
        const struct comparison_limit *limit = &pair->limits[k];
        double value = comparison_value(pair, item);
        char line[COMPARISON_LINE_BYTES], text[32] = "-";
        if (isnan(value))
            continue;
        if (!limit->is_off && isfinite(limit->value))
            snprintf(text, sizeof(text), "%.6g", limit->value);
        comparison_line(pair, item, line);
        const char *where = strstr(line, ", at ");
        fprintf(page, "<tr%s><td>%s</td><td>%.6g</td><td>%s</td><td>%.4g</td><td>%s</td></tr>\n",
                pair->out >> k & 1 ? " class=\"out\"" : "", comparison_key(item), value, text,
                100 * comparison_share_out(pair, item), where ? where + 5 : "");
    }
    fputs("</table>\n", page);
}

static void put_view(FILE *page, const struct compared_pair *pair, size_t p, int view)
{
    const double *limits = pair->comparison.limits;
    const struct {
        const char *name, *caption;
        double most;
        const char *unit;
    } maps[2] = {
        {"angle", "angle of the normals", MAP_LIMITS * limits[SHEEN_COMPARE_NORMAL], "degrees"},
        {"distance", "distance along the normal", MAP_LIMITS * limits[SHEEN_COMPARE_DISTANCE],
         "units"}};
    fprintf(page, "<h3>view %d, turned by %d degrees</h3>\n", view + 1, 360 / N_VIEWS * view);
    for (int k = 0; k < 2; k++)
        fprintf(page,
                "<figure><img src=\"p%zu-v%d-%s.png\" alt=\"%s\" width=\"%d\" height=\"%d\">"
                "<figcaption>%s</figcaption></figure>\n",
                p, view, k ? "new" : "old", k ? "new" : "old", WIDTH_PX, HEIGHT_PX,
                k ? "new" : "old");
    fprintf(page,
            "<figure><div class=\"blink\"><img src=\"p%zu-v%d-new.png\" alt=\"new\" width=\"%d\" "
            "height=\"%d\"><img class=\"over\" src=\"p%zu-v%d-old.png\" alt=\"old\" width=\"%d\" "
            "height=\"%d\"></div><figcaption>old and new in turn</figcaption></figure>\n",
            p, view, WIDTH_PX, HEIGHT_PX, p, view, WIDTH_PX, HEIGHT_PX);
    for (int k = 0; k < 2; k++)
        fprintf(
            page,
            "<figure><img src=\"p%zu-v%d-%s.png\" alt=\"%s\" width=\"%d\" height=\"%d\">"
            "<img src=\"scale.png\" alt=\"scale\"><figcaption>%s: black 0, white %.4g %s and more; "
            "grey: no surface; magenta: on one side only</figcaption></figure>\n",
            p, view, maps[k].name, maps[k].caption, WIDTH_PX, HEIGHT_PX, maps[k].caption,
            maps[k].most, maps[k].unit);
}

static enum sheen_status put_pair(struct report *report, const struct compared_pair *pair, size_t p)
{
    FILE *page = report->page;
    bool is_same = pair->verdict == COMPARISON_SAME;
    enum sheen_status status = SHEEN_OK;
    fprintf(page, "<h2 id=\"p%zu\">", p);
    put_text(page, pair->name);
    fprintf(page, ": <span class=\"%s\">%s</span></h2>\n", is_same ? "same" : "bad",
            comparison_verdict_text(pair));
    if (pair->verdict == COMPARISON_FAILED) {
        fputs("<p>", page);
        put_text(page, pair->failure);
        fputs("</p>\n", page);
    }
    if (!comparison_is_made(pair))
        return SHEEN_OK;
    put_table(page, pair);
    struct sheen_request request = report->options->request;
    request.width_px = WIDTH_PX;
    request.height_px = HEIGHT_PX;
    request.format = SHEEN_FORMAT_ZSTD;
    request.planes = SHEEN_PLANE_COLOUR | SHEEN_PLANE_POSITION | SHEEN_PLANE_NORMAL;
    status = settle_scene(report, pair, &request);
    const struct sheen_camera first = request.camera;
    double up[3];
    memcpy(up, report->frames[0].up, sizeof(up));
    for (int view = 0; view < N_VIEWS && !status; view++) {
        turntable_turn(&first, up, 2 * 3.14159265358979323846 * view / N_VIEWS, &request.camera);
        for (int side = 0; side < 2 && !status; side++)
            status = render_one(report, pair, side, &request);
        if (!status)
            status = write_view(report, pair, p, view);
        if (!status)
            put_view(page, pair, p, view);
    }
    return status;
}

static void put_overview(FILE *page, const struct compared_pair *pairs, size_t n)
{
    char counts[COMPARISON_COUNTS_BYTES];
    comparison_counts(pairs, n, counts);
    fprintf(page, "<h1>sheen compare: %s</h1>\n<ul>\n", counts);
    for (size_t i = 0; i < n; i++) {
        fprintf(page, "<li><a href=\"#p%zu\">", i);
        put_text(page, pairs[i].name);
        fprintf(page, "</a>: %s</li>\n", comparison_verdict_text(&pairs[i]));
    }
    fputs("</ul>\n", page);
}

static enum sheen_status write_pages(struct report *report, const struct compared_pair *pairs,
                                     size_t n)
{
    char path[PATH_BYTES];
    char *text = NULL;
    size_t n_bytes = 0;
    struct sheen_error *error = &report->client->error;
    report->page = open_memstream(&text, &n_bytes);
    if (!report->page)
        return failure_set(error, SHEEN_NO_MEMORY, "no memory for the report");
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>sheen "
          "compare</title>\n"
          "<link rel=\"stylesheet\" href=\"style.css\"></head><body>\n",
          report->page);
    put_overview(report->page, pairs, n);
    enum sheen_status status = write_scale(report);
    for (size_t i = 0; i < n && !status; i++)
        status = put_pair(report, &pairs[i], i);
    fputs("</body></html>\n", report->page);
    bool ok = !ferror(report->page);
    if (fclose(report->page) != 0 || !ok)
        status = failure_set(error, SHEEN_NO_MEMORY, "no memory for the report");
    path_of(report, path, "style.css");
    if (!status)
        status = file_write(path, (const uint8_t *)STYLE, sizeof(STYLE) - 1, error);
    path_of(report, path, "index.html");
    if (!status)
        status = file_write(path, (const uint8_t *)text, n_bytes, error);
    free(text);
    return status;
}

enum sheen_status report_write(struct client *client, const struct options *options,
                               const struct compared_pair *pairs, size_t n)
{
    struct report report = {.client = client,
                            .options = options,
                            .folder = options->report,
                            .frames = {SHEEN_FRAME_DEFAULTS, SHEEN_FRAME_DEFAULTS}};
    if (strlen(report.folder) > PATH_BYTES - 100)
        return failure_set(&client->error, SHEEN_BAD_IMAGE, "the path of --report is too long");
    if (mkdir(report.folder, 0777) != 0 && errno != EEXIST)
        return failure_set(&client->error, SHEEN_BAD_IMAGE, "%.300s: %s", report.folder,
                           strerror(errno));
    enum sheen_status status = write_pages(&report, pairs, n);
    for (int k = 0; k < 2; k++)
        sheen_frame_finish(&report.frames[k]);
    return status;
}
