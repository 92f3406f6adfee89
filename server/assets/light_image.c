#include "server/assets/light_image.h"

#include <stdlib.h>

struct image_build {
    struct build_order order;
    struct task task; /* measuring, decoding, then uploading */
    uint32_t max_px;
    struct image measured; /* what decoding gives at most; no pixels */
    struct light_image *image;
    bool ok;
    struct error error;
};

static void image_free(struct light_image *image)
{
    image_finish(&image->pixels);
    free(image);
}

static void end_build(struct image_build *build, bool ok)
{
    if (!ok)
        image_free(build->image);
    build->order.finished(build->order.owner, ok ? build->image : NULL, ok ? NULL : &build->error);
    free(build);
}

static void upload_run(struct task *task, void *context)
{
    struct image_build *build = task->owner;
    build->image->gpu = renderer_image_create(context, &build->image->pixels, &build->error);
}

static void upload_done(struct task *task)
{
    struct image_build *build = task->owner;
    end_build(build, build->image->gpu != NULL);
}

static struct workers_image file_of(const struct image_build *build)
{
    const struct build_order *order = &build->order;
    return (struct workers_image){order->file, order->file_bytes, order->name, build->max_px};
}

static size_t kept_bytes(const struct image_build *build, const struct image *pixels)
{
    return image_bytes(pixels) +
           renderer_image_bytes(render_thread_device(build->order.render_thread), pixels);
}

static void decode_run(struct task *task, void *context)
{
    (void)context;
    struct image_build *build = task->owner;
    const struct workers_image file = file_of(build);
    build->ok = workers_read_image(build->order.workers, &build->image->pixels, &file,
                                   image_bytes(&build->measured), &build->error);
}

static void decode_done(struct task *task)
{
    struct image_build *build = task->owner;
    const struct build_order *order = &build->order;
    if (build->ok) {
        build->image->reserved_bytes = kept_bytes(build, &build->image->pixels);
        order->reserve_work(order->owner, 0, &build->error); /* the rest is kept */
        build->ok = order->reserve(order->owner, build->image->reserved_bytes, &build->error);
    }
    if (!build->ok) {
        end_build(build, false);
        return;
    }
    order->progress->stage = "upload";
    build->task = (struct task){upload_run, upload_done, build, {NULL}};
    render_thread_submit(order->render_thread, &build->task);
}

static void measure_run(struct task *task, void *context)
{
    (void)context;
    struct image_build *build = task->owner;
    const struct workers_image file = file_of(build);
    build->ok = workers_measure_image(build->order.workers, &build->measured, &file, &build->error);
}

/* While the image is decoded there are the file's copy for the worker, the worker's answer, and what is
 * kept of it. */
static void measure_done(struct task *task)
{
    struct image_build *build = task->owner;
    const struct build_order *order = &build->order;
    if (build->ok) {
        const struct image *measured = &build->measured;
        const size_t need = order->file_bytes + image_bytes(measured) + kept_bytes(build, measured);
        build->ok = order->reserve_work(order->owner, need, &build->error);
    }
    if (!build->ok) {
        end_build(build, false);
        return;
    }
    build->task = (struct task){decode_run, decode_done, build, {NULL}};
    pool_submit(order->readers, &build->task, POOL_LATER);
}

bool light_image_build_start(const struct build_order *order, struct error *error)
{
    struct image_build *build = calloc(1, sizeof *build);
    struct light_image *image = calloc(1, sizeof *image);
    if (!build || !image) {
        free(build);
        free(image);
        return error_set(error, ERROR_SERVER, "%s: no memory to read it", order->name);
    }
    const struct renderer_info *info = render_thread_info(order->render_thread);
    build->order = *order;
    build->image = image;
    build->max_px =
        info->max_width_px < info->max_height_px ? info->max_width_px : info->max_height_px;
    if (build->max_px > order->max_image_px)
        build->max_px = order->max_image_px;
    order->progress->stage = "reading";
    build->task = (struct task){measure_run, measure_done, build, {NULL}};
    pool_submit(order->readers, &build->task, POOL_LATER);
    return true;
}

static void destroy_run(struct task *task, void *context)
{
    struct light_image *image = task->owner;
    renderer_image_destroy(context, image->gpu);
}

static void destroy_done(struct task *task)
{
    image_free(task->owner);
}

void light_image_destroy(struct light_image *image, struct render_thread *render_thread)
{
    image->destroy_task = (struct task){destroy_run, destroy_done, image, {NULL}};
    render_thread_submit(render_thread, &image->destroy_task);
}
