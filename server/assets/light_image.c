#include "server/assets/light_image.h"

#include <stdlib.h>

struct image_build {
    struct build_order order;
    struct task task; /* decoding, later uploading */
    uint32_t max_px;
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

static void decode_run(struct task *task, void *context)
{
    (void)context;
    struct image_build *build = task->owner;
    const struct build_order *order = &build->order;
    build->ok = workers_read_image(order->workers, &build->image->pixels, order->file,
                                   order->file_bytes, order->name, build->max_px, &build->error);
}

static void decode_done(struct task *task)
{
    struct image_build *build = task->owner;
    const struct build_order *order = &build->order;
    if (build->ok) {
        const struct image *pixels = &build->image->pixels;
        build->image->reserved_bytes =
            image_bytes(pixels) +
            renderer_image_bytes(render_thread_device(order->render_thread), pixels);
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
    build->task = (struct task){decode_run, decode_done, build, {NULL}};
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
