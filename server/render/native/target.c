#include "server/render/native/target.h"

#include <stdlib.h>

#include "server/render/native/frame.h"

/* Lays out planes one after the other. */
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

/* Lays out the planes of stage 2, where stage 3 finds them. */
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

/* Groups need a word each; a list of pixels may hold all of them. */
static void lay_out_lists(struct native_target *t, struct layout *layout)
{
    uint32_t pixels = layout->width * layout->height;
    uint32_t groups =
        ((layout->width - 1) / GROUP_WIDTH + 1) * ((layout->height - 1) / GROUP_HEIGHT + 1);
    for (int i = 0; i < NATIVE_LISTS; i++) {
        uint32_t n = i == NATIVE_GROUPS || i == NATIVE_SHADED_GROUPS ? groups : pixels;
        t->list[i] = (struct native_list){.at = {layout->next, n}};
        layout->next += n;
    }
}

/* Memory of which less than half is used IDLE_USES times in a row is freed, unless it is small: tiles at the right and
 * lower border are smaller than the others, and frames of other sizes come in between. The kernel clears what is
 * allocated again, which takes longer than a tile. */
static bool reserve(struct native_words *words, size_t n)
{
    enum { ALIGN = 64, SMALL_WORDS = 8 << 20, IDLE_USES = 256 };
    bool is_used = words->n / 2 <= n || (words->n <= SMALL_WORDS && n > 0);
    words->idle_uses = is_used ? 0 : words->idle_uses + 1;
    if (n <= words->n && words->idle_uses < IDLE_USES)
        return true;
    free(words->words);
    *words = (struct native_words){0};
    if (n == 0)
        return true;
    size_t bytes = (n * sizeof *words->words + ALIGN - 1) / ALIGN * ALIGN;
    words->words = native_allocate(bytes);
    words->n = words->words ? n : 0;
    return words->words;
}

static bool has_no_memory(uint32_t width, uint32_t height, struct error *error)
{
    return error_set(error, ERROR_SERVER, "out of memory for a tile of %ux%u", width, height);
}

bool native_target_reserve(struct native_target *t, uint32_t width, uint32_t height,
                           struct error *error)
{
    size_t pixels = (size_t)width * height;
    size_t groups = (size_t)((width - 1) / GROUP_WIDTH + 1) * ((height - 1) / GROUP_HEIGHT + 1);
    if (!reserve(&t->own, pixels * WORDS_PER_PX + 2 * groups)) {
        t->width = t->height = 0;
        return has_no_memory(width, height, error);
    }
    struct layout layout = {t->own.words, width, height};
    lay_out_surface(t, &layout);
    t->ends = take(&layout, 2);
    t->colour = take(&layout, 1);
    t->coverage = take(&layout, 1);
    lay_out_lists(t, &layout);
    t->width = width;
    t->height = height;
    return true;
}

bool native_target_reserve_shading(struct native_target *t, const struct frame_request *request,
                                   struct error *error)
{
    size_t pixels = (size_t)t->width * t->height;
    bool measures = request->planes & (PLANE_LIGHT | PLANE_CURVATURE | PLANE_LIGHT_CHANGE);
    if (!reserve(&t->of_lights, request->n_lights > 1 ? pixels * LIGHT_WORDS_PER_PX : 0) ||
        !reserve(&t->of_measures, measures ? pixels * MEASURE_WORDS_PER_PX : 0))
        return has_no_memory(t->width, t->height, error);
    struct layout layout = {t->of_lights.words, t->width, t->height};
    for (int i = 0; i < 2; i++) {
        t->lights[i] = take(&layout, 4);
        t->missed[i] = take(&layout, 1);
        t->uneven[i] = take(&layout, 1);
    }
    t->square_sum = take(&layout, 4);
    layout.next = t->of_measures.words;
    t->light_st = take(&layout, 2);
    t->curvature = take(&layout, 2);
    t->light_change = take(&layout, 4);
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
    free(target->own.words);
    free(target->of_lights.words);
    free(target->of_measures.words);
    free(target->hits);
    *target = (struct native_target){0};
}
