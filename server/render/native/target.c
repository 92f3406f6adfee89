#include "server/render/native/target.h"

#include <stdlib.h>

#include "server/render/native/frame.h"

/* Planes one after the other. */
struct layout {
    uint32_t *next;
    uint32_t width, height;
};

static struct native_image take(struct layout *layout, int channels)
{
    size_t pixels = (size_t)layout->width * layout->height;
    struct native_image image = {layout->next, (int32_t)layout->width, (int32_t)layout->height,
                                 channels, pixels};
    if (layout->next)
        layout->next += pixels * (size_t)channels;
    return image;
}

static float *floats(const struct native_image *image, int channel)
{
    return (float *)(void *)(image->words + (size_t)channel * image->channel_words);
}

/* Of stage 2, where stage 3 finds them. */
static void lay_out_surface(struct native_target *t, struct layout *layout)
{
    t->hit_depth = take(layout, 1);
    t->normal = take(layout, 4);
    t->shape = take(layout, 2);
    t->border = take(layout, 1);
    t->seen = take(layout, 2);
    t->seen_depth = take(layout, 1);
    t->ptex = take(layout, 3);
    t->planes = (struct native_planes){
        .pitch = layout->width,
        .depth = floats(&t->hit_depth, 0),
        .normal = {floats(&t->normal, 0), floats(&t->normal, 1), floats(&t->normal, 2)},
        .shape = {floats(&t->shape, 0), floats(&t->shape, 1), floats(&t->normal, 3)},
        .face = t->ptex.words,
        .u = floats(&t->ptex, 1),
        .v = floats(&t->ptex, 2),
        .border = t->border.words,
        .node = t->seen.words,
        .where = t->seen.words + t->seen.channel_words,
    };
}

static void lay_out(struct native_target *t, struct layout *layout)
{
    lay_out_surface(t, layout);
    t->ends = take(layout, 2);
    t->colour = take(layout, 1);
    t->coverage = take(layout, 1);
    t->light_st = take(layout, 2);
    t->curvature = take(layout, 2);
    t->light_change = take(layout, 4);
    for (int i = 0; i < 2; i++) {
        t->lights[i] = take(layout, 4);
        t->missed[i] = take(layout, 1);
    }
    uint32_t pixels = layout->width * layout->height;
    for (int i = 0; i < NATIVE_LISTS; i++)
        t->list[i] = (struct native_list){.at = {take(layout, 1).words, pixels}};
}

/* What lay_out() takes of a pixel: planes, and a word of each list. */
enum { WORDS_PER_PX = 1 + 4 + 2 + 1 + 2 + 1 + 3 + 4 + 2 + 2 + 4 + 2 * 5 + NATIVE_LISTS };

bool native_target_reserve(struct native_target *target, uint32_t width, uint32_t height,
                           struct error *error)
{
    size_t n = (size_t)width * height * WORDS_PER_PX;
    if (!native_grow(&target->words, &target->n_words, n, sizeof *target->words))
        return error_set(error, ERROR_SERVER, "out of memory for a tile of %ux%u", width, height);
    struct layout layout = {target->words, width, height};
    lay_out(target, &layout);
    target->width = width;
    target->height = height;
    return true;
}

bool native_target_reserve_hits(struct native_target *target, size_t n_rays, struct error *error)
{
    return native_grow(&target->hits, &target->n_hit_words, n_rays * HIT_WORDS,
                       sizeof *target->hits) ||
           error_set(error, ERROR_SERVER, "out of memory for the rays of a tile");
}

void native_target_finish(struct native_target *target)
{
    free(target->words);
    free(target->hits);
    *target = (struct native_target){0};
}
