/* Finds the groups of pixels near what is seen, in a band of rows per thread; lists them in order of rows. */
#include <string.h>

#include "server/render/native/sets.h"
#include "server/render/native/stages.h"

/* Threads store what they find in lists that are unused at that time. */
enum { FOUND_IN_BANDS = NATIVE_FOUND_EDGES, COLUMNS = NATIVE_RIMS };

struct search {
    const struct native_set *set;
    struct native_target *target;
    struct native_seen seen;
};

static uint32_t *words_of(const struct native_target *target, int list)
{
    return target->list[list].at.words;
}

static uint32_t groups_before(const struct native_target *target, uint32_t row)
{
    return row / GROUP_HEIGHT * ((target->width + GROUP_WIDTH - 1) / GROUP_WIDTH);
}

static void search_rows(void *owner, uint32_t first, uint32_t end)
{
    struct search *search = owner;
    const struct native_target *t = search->target;
    uint32_t *columns = words_of(t, COLUMNS) + (size_t)first * t->width;
    words_of(t, FOUND_IN_BANDS)[first / NATIVE_BAND] =
        search->set->groups(&search->seen, first, end, (float *)(void *)columns,
                            words_of(t, NATIVE_GROUPS) + groups_before(t, first));
}

/* Lists those of all groups that the tile itself reaches into. */
static void list_shaded(const struct native_list *all, const struct tile *in,
                        struct native_list *shaded)
{
    shaded->n = 0;
    for (uint32_t i = 0; i < all->n; i++) {
        uint32_t group = all->at.words[i];
        uint32_t x = (group & 0xffff) * GROUP_WIDTH, y = (group >> 16) * GROUP_HEIGHT;
        if (x + GROUP_WIDTH > in->x && x < in->x + in->width && y + GROUP_HEIGHT > in->y &&
            y < in->y + in->height)
            shaded->at.words[shaded->n++] = group;
    }
}

void native_find_groups(const struct native_drawing *d)
{
    struct native_target *t = d->target;
    struct native_list *all = &t->list[NATIVE_GROUPS];
    struct search search = {
        native_device_set(d->device),
        t,
        {.planes = &t->planes,
         .width = t->width,
         .height = t->height,
         .ndc = request_has_coverage(d->request) ? (float *)(void *)t->seen_depth.words : NULL,
         .is_perspective = d->view.ray[0] > 0}};
    memcpy(search.seen.depth, d->view.depth, sizeof search.seen.depth);
    native_device_rows(d->device, t->height, search_rows, &search);
    all->n = 0;
    for (uint32_t y = 0; y < t->height; y += NATIVE_BAND) {
        uint32_t n = words_of(t, FOUND_IN_BANDS)[y / NATIVE_BAND];
        memmove(all->at.words + all->n, all->at.words + groups_before(t, y), n * sizeof(uint32_t));
        all->n += n;
    }
    list_shaded(all, &d->inside, &t->list[NATIVE_SHADED_GROUPS]);
}

bool native_any_seen(const struct native_target *target)
{
    return target->list[NATIVE_SHADED_GROUPS].n > 0;
}
