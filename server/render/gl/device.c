#include "server/render/gl/device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/render/gl/device_internal.h"
#include "server/render/gl/maker/maker.h"
#include "server/render/gl/polygon_meshes.h"
#include "server/render/gl/paused_tiles.h"
#include "server/render/gl/stage_clock.h"
#include "server/render/gl/shade.h"
#include "server/render/gl/edges.h"
#include "server/render/gl/evaluate.h"
#include "server/render/gl/gather.h"
#include "server/render/gl/visibility.h"
#include "server/render/gl/frame.h"
#include "server/render/gl/kept.h"
#include "server/render/gl/light_image.h"
#include "server/render/gl/model.h"

enum { MAX_USUAL_PROGRAMS = 2 * TABLE_PROGRAMS + 2 + MAX_FRAME_PROGRAMS };

static void query_info(struct gl_renderer *r)
{
    GLint texels = 0, texture = 0, viewport[2] = {0, 0};
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    GLint width = texture < viewport[0] ? texture : viewport[0];
    GLint height = texture < viewport[1] ? texture : viewport[1];
    snprintf(r->device, sizeof r->device, "%s", (const char *)glGetString(GL_RENDERER));
    snprintf(r->driver, sizeof r->driver, "%s", (const char *)glGetString(GL_VERSION));
    r->base.info = (struct renderer_info){
        .device = r->device,
        .driver = r->driver,
        .software = r->context.egl.software,
        .max_width_px = (uint32_t)width,
        .max_height_px = (uint32_t)height,
    };
    r->base.info.timed_by_device = stage_clock_by_device(r);
    size_t most = r->base.options.max_texels;
    r->max_texels = most && most < (size_t)texels ? most : (size_t)texels;
}

/* The objects that every context needs. */
static bool begin_context(struct gl_renderer *r, struct error *error)
{
    r->context.number++;
    const struct maker_watch watch = {r->base.options.compiling, r->base.options.owner};
    r->maker = maker_create(&r->context.egl, r->programs, watch, error);
    if (!r->maker)
        return false;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    stage_clock_init(r);
    glCreateBuffers(1, &r->view_buffer);
    glNamedBufferData(r->view_buffer, sizeof(struct view_block), NULL, GL_STREAM_DRAW);
    return stage_visibility_init(&r->visibility, error) && stage_gather_init(&r->gather, error) &&
           stage_evaluate_init(&r->evaluate, error) && stage_edges_init(&r->edges, error) &&
           stage_shade_init(&r->shade, error);
}

static void destroy(struct renderer *renderer)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    maker_destroy(r->maker);
    kept_programs_release(r->programs);
    /* GL objects end with their context. */
    egl_finish(&r->context.egl);
    patch_grids_finish(&r->grids);
    polygons_lose(&r->meshes);
    paused_tiles_release(r->paused_tiles);
    free(r);
}

/* The programs of usual frames: one light around the model, planes of lines and curvature, and
 * polygons; of models whose tables fit into one texture each. Returns their number. */
static int usual_programs(const struct gl_renderer *r,
                          struct program_id ids[static MAX_USUAL_PROGRAMS])
{
    static const struct frame_request usual = {.n_lights = 1,
                                               .lights = {{.kind = LIGHT_TUNNEL}},
                                               .count_light = true,
                                               .planes = PLANE_LIGHT};
    const struct gl_model model = {.points.n = 1, .nodes.n = 1, .adjacency.n = 1};
    int n = 2 * TABLE_PROGRAMS;
    gl_model_programs(r, &model, false, ids);
    gl_model_programs(r, &model, true, ids + TABLE_PROGRAMS);
    n += stage_shade_programs(&usual, ids + n);
    ids[n++] = (struct program_id){.set = SET_SINGLE, .which = PROGRAM_POLYGONS};
    ids[n++] = (struct program_id){.set = SET_SINGLE, .which = PROGRAM_WIREFRAME};
    return n;
}

static void warm_up(struct gl_renderer *r)
{
    struct program_id ids[MAX_USUAL_PROGRAMS];
    const int n = usual_programs(r, ids);
    for (int i = 0; i < n; i++)
        kept_programs_order(r->programs, &ids[i]);
}

static struct renderer *create(const struct renderer_options *options, struct error *error)
{
    struct gl_renderer *r = calloc(1, sizeof *r);
    if (!r) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    r->base.device = &gl_device;
    r->base.options = *options;
    r->context.lost = options->lost;
    r->context.owner = options->owner;
    r->paused_tiles = paused_tiles_create();
    r->programs = kept_programs_create(options->woken, options->owner);
    if (!r->paused_tiles || !r->programs) {
        error_set(error, ERROR_SERVER, "out of memory");
        destroy(&r->base);
        return NULL;
    }
    if (!egl_init(&r->context.egl, options->device ? options->device : "auto", error)) {
        destroy(&r->base);
        return NULL;
    }
    query_info(r);
    if (!begin_context(r, error)) {
        destroy(&r->base);
        return NULL;
    }
    struct program_id usual[MAX_USUAL_PROGRAMS];
    r->base.info.usual_programs_bytes = (uint64_t)usual_programs(r, usual) * PROGRAM_BYTES;
    if (options->warm_up)
        warm_up(r);
    return &r->base;
}

/* Makes sure that a context exists: opens another in place of a lost one. ERROR_GPU_LOST if the
 * device does not give one yet. */
static bool make_ready(struct gl_renderer *r, struct error *error)
{
    if (!r->context.is_lost)
        return true;
    /* Only the copies in main memory remain; every GL name ended with the context. */
    maker_destroy(r->maker);
    kept_programs_forget(r->programs);
    polygons_lose(&r->meshes);
    const struct gl_renderer old = *r;
    *r = (struct gl_renderer){.base = old.base,
                              .context = old.context,
                              .max_texels = old.max_texels,
                              .grids = old.grids,
                              .paused_tiles = old.paused_tiles,
                              .programs = old.programs,
                              .next_serial = old.next_serial};
    r->context.is_lost = false;
    memcpy(r->device, old.device, sizeof r->device);
    memcpy(r->driver, old.driver, sizeof r->driver);
    struct error why;
    if (egl_reopen(&r->context.egl) && begin_context(r, &why) && !context_check_lost(&r->context))
        return true;
    if (!r->context.is_lost)
        context_lose(&r->context);
    return error_set(error, ERROR_GPU_LOST,
                     "the GPU was lost and does not come back yet: try again later");
}

/* A model or image that is created while the device is lost is uploaded with its first frame. */
static struct renderer_model *create_model(struct renderer *renderer,
                                           const struct limit_tables *tables, struct error *error)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_model *model = gl_model_create(tables, ++r->next_serial, error);
    if (!model)
        return NULL;
    if (!make_ready(r, error) || gl_model_upload(r, model, error) ||
        context_check_lost(&r->context))
        return &model->base;
    gl_model_destroy(renderer, &model->base);
    return NULL;
}

static void destroy_model(struct renderer *renderer, struct renderer_model *model)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    const struct gl_model *on_device = gl_model_of(model);
    if (context_is_current(&r->context, on_device->context))
        polygons_forget(&r->meshes, on_device->serial);
    gl_model_destroy(renderer, model);
}

static struct renderer_image *create_image(struct renderer *renderer, const struct image *pixels,
                                           struct error *error)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_image *image = gl_image_create(pixels, error);
    if (!image)
        return NULL;
    if (!make_ready(r, error) || gl_image_upload(r, image, error) ||
        context_check_lost(&r->context))
        return &image->base;
    gl_image_destroy(renderer, &image->base);
    return NULL;
}

static enum frame_step step(struct renderer *renderer, struct renderer_model *model,
                            struct frame_work *work, struct frame *frame, struct error *error)
{
    make_ready(gl_renderer_of(renderer), error);
    return gl_frame_step(renderer, model, work, frame, error);
}

static struct renderer_held held(const struct renderer *renderer)
{
    const struct gl_renderer *r = (const struct gl_renderer *)(const void *)renderer;
    const uint64_t programs = (uint64_t)kept_programs_count(r->programs) * PROGRAM_BYTES;
    const uint64_t usual = r->base.info.usual_programs_bytes;
    return (struct renderer_held){.frames = r->context.is_lost ? 0 : planes_bytes(r),
                                  .programs = programs > usual ? programs - usual : 0};
}

static void drop_held(struct renderer *renderer)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    if (r->context.is_lost)
        return;
    planes_drop(r);
    kept_programs_drop(r->programs, (unsigned)(r->base.info.usual_programs_bytes / PROGRAM_BYTES));
}

const struct renderer_device gl_device = {
    .create = create,
    .destroy = destroy,
    .model_create = create_model,
    .model_destroy = destroy_model,
    .image_create = create_image,
    .image_destroy = gl_image_destroy,
    .model_bytes = limit_tables_bytes,
    .image_bytes = gl_image_bytes,
    .frame_bytes = gl_frame_bytes,
    .paused_bytes = gl_paused_bytes,
    .held = held,
    .drop_held = drop_held,
    .begin = gl_frame_begin,
    .step = step,
};
