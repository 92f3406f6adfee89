/* The part of the renderer that all devices share; the rest goes to the device. */
#include "server/render/renderer.h"

#include "server/render/device.h"
#include "server/render/tiles.h"
#include "server/scene/request_check.h"

struct renderer *renderer_create(const struct renderer_device *device,
                                 const struct renderer_options *options, struct error *error)
{
    return device->create(options, error);
}

void renderer_destroy(struct renderer *renderer)
{
    if (renderer)
        renderer->device->destroy(renderer);
}

const struct renderer_info *renderer_info(const struct renderer *renderer)
{
    return &renderer->info;
}

struct renderer_model *renderer_model_create(struct renderer *renderer,
                                             const struct limit_tables *tables, struct error *error)
{
    return renderer->device->model_create(renderer, tables, error);
}

void renderer_model_destroy(struct renderer *renderer, struct renderer_model *model)
{
    if (model)
        renderer->device->model_destroy(renderer, model);
}

struct renderer_image *renderer_image_create(struct renderer *renderer, const struct image *image,
                                             struct error *error)
{
    const struct renderer_info *info = &renderer->info;
    if (image->width_px > info->max_width_px || image->height_px > info->max_height_px) {
        error_set(error, ERROR_IMAGE, "the image is %ux%u, more than the device's %ux%u",
                  image->width_px, image->height_px, info->max_width_px, info->max_height_px);
        return NULL;
    }
    return renderer->device->image_create(renderer, image, error);
}

void renderer_image_destroy(struct renderer *renderer, struct renderer_image *image)
{
    if (image)
        renderer->device->image_destroy(renderer, image);
}

bool renderer_takes_tables_on_demand(const struct renderer_device *device)
{
    return device->on_demand;
}

size_t renderer_model_bytes(const struct renderer_device *device, const struct limit_tables *tables)
{
    return device->model_bytes(tables);
}

size_t renderer_image_bytes(const struct renderer_device *device, const struct image *image)
{
    return device->image_bytes(image);
}

uint64_t renderer_frame_bytes(const struct renderer_device *device,
                              const struct renderer_frame_size *size)
{
    struct renderer_frame_size drawn = *size;
    drawn.width_px += size->is_part ? 2 * TILE_MARGIN_PX : 0;
    drawn.height_px += size->is_part ? 2 * TILE_MARGIN_PX : 0;
    return device->frame_bytes(&drawn);
}

struct renderer_held renderer_held(const struct renderer *renderer)
{
    return renderer->device->held(renderer);
}

void renderer_drop_held(struct renderer *renderer)
{
    renderer->device->drop_held(renderer);
}

uint64_t renderer_paused_bytes(const struct renderer_device *device, uint32_t width_px,
                               uint32_t height_px, uint64_t tile_px)
{
    return device->paused_bytes(width_px, height_px, tile_px);
}

bool renderer_begin(struct renderer *renderer, struct frame_work *work, struct frame *frame,
                    struct error *error)
{
    const struct renderer_info *info = &renderer->info;
    *frame = (struct frame){0};
    work->has_drawn = false;
    work->state = NULL;
    if (!request_check(work->request, info->max_width_px, info->max_height_px, error) ||
        !frame_init(frame, work->request, renderer->options.block_cache, error))
        return false;
    if (renderer->device->begin(renderer, work, error))
        return true;
    frame_finish(frame);
    return false;
}

enum frame_step renderer_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error)
{
    work->has_drawn = false;
    enum frame_step next = renderer->device->step(renderer, model, work, frame, error);
    if (next == FRAME_DONE || next == FRAME_FAILED)
        frame_work_finish(work);
    if (next == FRAME_FAILED)
        frame_finish(frame);
    return next;
}

void frame_work_finish(struct frame_work *work)
{
    if (work->state)
        work->state->destroy(work->state);
    work->state = NULL;
}

bool renderer_render(struct renderer *renderer, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error)
{
    struct frame_work work = {.request = request};
    struct renderer_polygons *polygons = NULL;
    if (!renderer_begin(renderer, &work, frame, error))
        return false;
    enum frame_step next;
    do {
        next = renderer_step(renderer, model, &work, frame, error);
        if (next == FRAME_POLYGONS) {
            renderer_polygons_destroy(polygons); /* polygons made for a device that was lost */
            work.polygons = polygons =
                renderer_polygons_create(model->tables, request->surface.level, &work.watch, error);
            next = polygons ? FRAME_MORE : FRAME_FAILED;
        }
    } while (next == FRAME_MORE);
    if (next == FRAME_FAILED) {
        frame_work_finish(&work);
        frame_finish(frame);
    }
    renderer_polygons_destroy(polygons);
    return next == FRAME_DONE;
}
