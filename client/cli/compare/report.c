#include "client/cli/compare/report.h"

#include <errno.h>
#include <math.h>
#include <openssl/evp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "client/cli/base/failure.h"
#include "client/cli/compare/aligned.h"
#include "client/cli/compare/report_page.h"
#include "client/cli/files/file.h"
#include "client/cli/output/canvas.h"
#include "client/cli/output/heat_map.h"
#include "client/cli/turntable.h"

enum { N_VIEWS = 4, SCALE_HEIGHT_PX = 16, PATH_BYTES = 4200 };
/* Maps end at so many times the limit. */
static const double MAP_LIMITS = 4;

struct report {
    struct client *client;
    const struct options *options;
    const struct views *views;
    const char *folder; /* NULL: pictures are in the page */
    FILE *page;
    char *scale;                  /* address of the picture of the scale */
    struct sheen_frame frames[2]; /* old, new */
};

static void path_of(const struct report *report, char path[static PATH_BYTES], const char *name)
{
    snprintf(path, PATH_BYTES, "%s/%s", report->folder, name);
}

/* --- pictures */

/* A data: address of the canvas as a PNG file. malloc'd. */
static enum sheen_status encode_picture(struct report *report, const struct canvas *canvas,
                                        char **address)
{
    static const char head[] = "data:image/png;base64,";
    uint8_t *file = NULL;
    size_t n_bytes = 0, n_head = sizeof(head) - 1;
    enum sheen_status status = canvas_png(canvas, &file, &n_bytes, &report->client->error);
    if (status)
        return status;
    *address = malloc(n_head + (n_bytes + 2) / 3 * 4 + 1);
    if (*address) {
        memcpy(*address, head, n_head);
        EVP_EncodeBlock((unsigned char *)*address + n_head, file, (int)n_bytes);
    } else {
        status = failure_set(&report->client->error, SHEEN_NO_MEMORY, "no memory for a picture");
    }
    free(file);
    return status;
}

/* Writes a picture into the folder, or gets it as text, and gets its address. malloc'd. */
static enum sheen_status put_picture(struct report *report, const struct canvas *canvas,
                                     const char *name, char **address)
{
    char path[PATH_BYTES];
    if (!report->folder)
        return encode_picture(report, canvas, address);
    if (!(*address = strdup(name)))
        return failure_set(&report->client->error, SHEEN_NO_MEMORY, "no memory for a picture");
    path_of(report, path, name);
    return canvas_write_png(canvas, path, &report->client->error);
}

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
                      (double)REPORT_WIDTH_PX / REPORT_HEIGHT_PX, NULL);
    return status;
}

/* Renders both models with the same camera; the new one as it was aligned. */
static enum sheen_status render_both(struct report *report, const struct compared_pair *pair,
                                     const struct sheen_request *scene)
{
    const struct sheen_comparison *comparison = &pair->comparison;
    struct sheen_request request = *scene;
    enum sheen_status status = render_one(report, pair, 0, &request);
    if (status)
        return status;
    request = *scene;
    request.camera = report->frames[0].camera;
    if (comparison->is_aligned)
        aligned_request(comparison, &request);
    status = render_one(report, pair, 1, &request);
    if (!status && comparison->is_aligned)
        aligned_frame(comparison, &report->frames[1], (size_t)REPORT_WIDTH_PX * REPORT_HEIGHT_PX);
    return status;
}

static void paint(const struct report *report, const struct report_view *view,
                  enum report_picture picture, struct canvas *canvas)
{
    if (picture == PICTURE_OLD || picture == PICTURE_NEW) {
        memset(canvas->rgb, 0xff, (size_t)3 * REPORT_WIDTH_PX * REPORT_HEIGHT_PX);
        canvas_picture(canvas, 0, 0, report->frames[picture].plane[0], REPORT_WIDTH_PX,
                       REPORT_HEIGHT_PX);
    } else {
        heat_map_paint(canvas, picture == PICTURE_ANGLE ? HEAT_NORMAL : HEAT_DISTANCE,
                       &report->frames[0], &report->frames[1], view->most[picture]);
    }
}

/* Puts the pictures of a view into the report: in a folder as pP-vV-old.png and so on. */
static enum sheen_status put_view(struct report *report, const struct compared_pair *pair, size_t p,
                                  size_t v, const char *title)
{
    static const char *const names[PICTURES] = {"old", "new", "angle", "distance"};
    const double *limits = pair->comparison.limits;
    struct report_view view = {
        .title = title,
        .scale = report->scale,
        .most = {[PICTURE_ANGLE] = MAP_LIMITS * limits[SHEEN_COMPARE_NORMAL],
                 [PICTURE_DISTANCE] = MAP_LIMITS * limits[SHEEN_COMPARE_DISTANCE]},
        .is_aligned = pair->comparison.is_aligned,
    };
    struct canvas canvas;
    enum sheen_status status = SHEEN_OK;
    if (!canvas_init(&canvas, REPORT_WIDTH_PX, REPORT_HEIGHT_PX))
        return failure_set(&report->client->error, SHEEN_NO_MEMORY, "no memory for a picture");
    for (int k = 0; k < PICTURES && !status; k++) {
        char name[64];
        paint(report, &view, (enum report_picture)k, &canvas);
        snprintf(name, sizeof(name), "p%zu-v%zu-%s.png", p, v, names[k]);
        status = put_picture(report, &canvas, name, &view.source[k]);
    }
    canvas_finish(&canvas);
    if (!status)
        report_page_view(report->page, &view);
    for (int k = 0; k < PICTURES; k++)
        free(view.source[k]);
    return status;
}

static enum sheen_status put_scale(struct report *report)
{
    struct canvas canvas;
    if (!canvas_init(&canvas, REPORT_WIDTH_PX / 2, SCALE_HEIGHT_PX))
        return failure_set(&report->client->error, SHEEN_NO_MEMORY, "no memory for a picture");
    heat_map_paint_scale(&canvas);
    enum sheen_status status = put_picture(report, &canvas, "scale.png", &report->scale);
    canvas_finish(&canvas);
    return status;
}

/* --- pages */

/* The camera and the title of view v: of the file, or `first` turned about `up`. */
static void choose_view(const struct report *report, size_t v, const struct sheen_camera *first,
                        const double up[3], struct sheen_camera *camera,
                        char title[static VIEW_BYTES])
{
    if (report->views->n) {
        *camera = report->views->list[v].camera;
        snprintf(title, VIEW_BYTES, "%s", report->views->list[v].text);
        return;
    }
    turntable_turn(first, up, 2 * 3.14159265358979323846 * (double)v / N_VIEWS, camera);
    snprintf(title, VIEW_BYTES, "view %zu, turned by %zu degrees", v + 1, 360 / N_VIEWS * v);
}

static enum sheen_status put_pair(struct report *report, const struct compared_pair *pair, size_t p)
{
    report_page_pair(report->page, pair, p);
    if (!comparison_is_made(pair))
        return SHEEN_OK;
    struct sheen_request request = report->options->request;
    request.width_px = REPORT_WIDTH_PX;
    request.height_px = REPORT_HEIGHT_PX;
    request.format = SHEEN_FORMAT_ZSTD;
    request.planes = SHEEN_PLANE_COLOUR | SHEEN_PLANE_POSITION | SHEEN_PLANE_NORMAL;
    enum sheen_status status = settle_scene(report, pair, &request);
    const struct sheen_camera first = request.camera;
    size_t n = report->views->n ? report->views->n : N_VIEWS;
    double up[3];
    memcpy(up, report->frames[0].up, sizeof(up));
    for (size_t v = 0; v < n && !status; v++) {
        char title[VIEW_BYTES];
        choose_view(report, v, &first, up, &request.camera, title);
        status = render_both(report, pair, &request);
        if (!status)
            status = put_view(report, pair, p, v, title);
    }
    return status;
}

static enum sheen_status write_text(struct report *report, const char *name, const char *text)
{
    char path[PATH_BYTES];
    path_of(report, path, name);
    return file_write(path, (const uint8_t *)text, strlen(text), &report->client->error);
}

/* Makes the page, and writes all files; `path` is that of the page. */
static enum sheen_status write_page(struct report *report, const char *path,
                                    const struct compared_pair *pairs, size_t n)
{
    char *text = NULL;
    size_t n_bytes = 0;
    struct sheen_error *error = &report->client->error;
    report->page = open_memstream(&text, &n_bytes);
    if (!report->page)
        return failure_set(error, SHEEN_NO_MEMORY, "no memory for the report");
    report_page_begin(report->page, pairs, n, !report->folder);
    enum sheen_status status = put_scale(report);
    for (size_t i = 0; i < n && !status; i++)
        status = put_pair(report, &pairs[i], i);
    report_page_end(report->page);
    bool ok = !ferror(report->page);
    if (fclose(report->page) != 0 || !ok)
        status = failure_set(error, SHEEN_NO_MEMORY, "no memory for the report");
    if (!status && report->folder)
        status = write_text(report, "style.css", REPORT_STYLE);
    if (!status && report->folder)
        status = write_text(report, "zoom.js", REPORT_SCRIPT);
    if (!status)
        status = file_write(path, (const uint8_t *)text, n_bytes, error);
    free(text);
    free(report->scale);
    for (int k = 0; k < 2; k++)
        sheen_frame_finish(&report->frames[k]);
    return status;
}

static struct report report_of(struct client *client, const struct options *options,
                               const struct views *views, const char *folder)
{
    return (struct report){.client = client,
                           .options = options,
                           .views = views,
                           .folder = folder,
                           .frames = {SHEEN_FRAME_DEFAULTS, SHEEN_FRAME_DEFAULTS}};
}

enum sheen_status report_write_folder(struct client *client, const struct options *options,
                                      const struct views *views, const struct compared_pair *pairs,
                                      size_t n)
{
    struct report report = report_of(client, options, views, options->report);
    char path[PATH_BYTES];
    if (strlen(report.folder) > PATH_BYTES - 100)
        return failure_set(&client->error, SHEEN_BAD_IMAGE, "the path of --report is too long");
    if (mkdir(report.folder, 0777) != 0 && errno != EEXIST)
        return failure_set(&client->error, SHEEN_BAD_IMAGE, "%.300s: %s", report.folder,
                           strerror(errno));
    path_of(&report, path, "index.html");
    return write_page(&report, path, pairs, n);
}

enum sheen_status report_write_file(struct client *client, const struct options *options,
                                    const struct views *views, const struct compared_pair *pairs,
                                    size_t n)
{
    struct report report = report_of(client, options, views, NULL);
    return write_page(&report, options->html, pairs, n);
}
