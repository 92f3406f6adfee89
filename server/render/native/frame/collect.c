#include "server/render/native/frame/collect.h"

#include <string.h>

/* A tile whose planes are copied into those of its picture. */
struct copying {
    const struct native_drawing *tile;
    const struct native_target *picture;
};

/* Copies a rectangle of the tile's target. */
static void copy_image(const struct native_drawing *d, const struct native_image *from,
                       const struct native_image *to, const struct tile *part)
{
    for (int c = 0; c < from->channels; c++)
        for (uint32_t y = part->y; y < part->y + part->height; y++)
            memcpy(to->words + (size_t)c * to->channel_words +
                       (size_t)(d->place.y + y) * (size_t)to->width + d->place.x + part->x,
                   from->words + (size_t)c * from->channel_words + (size_t)y * (size_t)from->width +
                       part->x,
                   part->width * sizeof *from->words);
}

/* Copies the planes that are read at every pixel, whether it shows surface or not. */
static void copy_rows(void *owner, uint32_t first, uint32_t end)
{
    const struct copying *copying = owner;
    const struct native_drawing *d = copying->tile;
    const struct native_target *from = d->target, *to = copying->picture;
    const struct tile part = {d->inside.x, d->inside.y + first, d->inside.width, end - first};
    copy_image(d, &from->hit_depth, &to->hit_depth, &part);
    copy_image(d, &from->coverage, &to->coverage, &part);
}

static uint32_t later(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static uint32_t sooner(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* The part of n groups, one beside the other, that is inside the tile. False if there is none. */
static bool groups_inside(const struct tile *inside, uint32_t group, uint32_t n, struct tile *part)
{
    const uint32_t x = (group & 0xffff) * GROUP_WIDTH, y = (group >> 16) * GROUP_HEIGHT;
    const uint32_t end_x = sooner(x + n * GROUP_WIDTH, inside->x + inside->width);
    const uint32_t end_y = sooner(y + GROUP_HEIGHT, inside->y + inside->height);
    part->x = later(x, inside->x);
    part->y = later(y, inside->y);
    if (part->x >= end_x || part->y >= end_y)
        return false;
    part->width = end_x - part->x;
    part->height = end_y - part->y;
    return true;
}

/* Copies the other planes. They are undefined where no surface is met, so that only groups of pixels near surface
 * are copied. */
static void copy_groups(void *owner, uint32_t first, uint32_t end)
{
    const struct copying *copying = owner;
    const struct native_drawing *d = copying->tile;
    const struct native_target *from = d->target, *to = copying->picture;
    const uint32_t *groups = from->list[NATIVE_GROUPS].at.words;
    for (uint32_t n; first < end; first += n) {
        struct tile part;
        for (n = 1; first + n < end && groups[first + n] == groups[first] + n;)
            n++;
        if (!groups_inside(&d->inside, groups[first], n, &part))
            continue;
        copy_image(d, &from->normal, &to->normal, &part);
        copy_image(d, &from->shape, &to->shape, &part);
        copy_image(d, &from->border, &to->border, &part);
        copy_image(d, &from->ptex, &to->ptex, &part);
        copy_image(d, &from->ends, &to->ends, &part);
    }
}

/* Adds what a list of the tile holds, with the tile's place in the picture. */
static void append(const struct native_list *from, struct native_list *to, uint32_t x, uint32_t y)
{
    for (uint32_t i = 0; i < from->n; i++)
        to->at.words[to->n + i] = from->at.words[i] + (x | y << 16);
    to->n += from->n;
}

/* The y of a listed rounded pixel has 15 bits (AT_EDGE in shaders/rounded.glsl). */
enum { MOST_LISTED_ROWS = 0x8000 };

static bool append_rounded(const struct native_drawing *d, struct native_target *to)
{
    struct error error;
    const struct native_list *from = &d->target->list[NATIVE_ROUNDED];
    struct native_list *all = &to->list[NATIVE_ROUNDED];
    size_t words = (size_t)NATIVE_MAX_RAYS * HIT_WORDS, n = all->n + (size_t)from->n;
    if (d->request->height_px > MOST_LISTED_ROWS || n > ROUNDED_IN_ANY_CUT ||
        !native_target_reserve_hits(to, n * NATIVE_MAX_RAYS, &error))
        return false;
    if (from->n)
        memcpy(to->hits + all->n * words, d->target->hits, from->n * words * sizeof *to->hits);
    append(from, all, d->place.x, d->place.y);
    return true;
}

bool native_collect(const struct native_drawing *d, struct native_target *to)
{
    const struct native_list *groups = d->target->list;
    struct copying copying = {d, to};
    native_device_rows(d->device, d->inside.height, copy_rows, &copying);
    native_device_rows(d->device, groups[NATIVE_GROUPS].n, copy_groups, &copying);
    for (int i = NATIVE_GROUPS; i <= NATIVE_SHADED_GROUPS; i++)
        append(&groups[NATIVE_SHADED_GROUPS], &to->list[i], d->place.x / GROUP_WIDTH,
               d->place.y / GROUP_HEIGHT);
    if (!request_has_coverage(d->request))
        return true;
    append(&d->target->list[NATIVE_EDGES], &to->list[NATIVE_EDGES], d->place.x, d->place.y);
    return append_rounded(d, to);
}
