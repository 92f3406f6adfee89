#include "server/render/native/frame/kept.h"

#include <string.h>

/* Finds the planes that hold the frame's view, equal bit by bit to planes drawn anew. NULL if there are none. */
static struct native_view_planes *find_kept(struct native_renderer *r,
                                            const struct native_shown *shown,
                                            const struct frame_work *work, bool is_single)
{
    for (int i = NATIVE_WHOLE; i <= NATIVE_TILED; i++) {
        struct native_view_planes *planes = &r->planes[i];
        bool same_cut = is_single == (i != NATIVE_TILED);
        if ((same_cut || planes->kept.any_cut) &&
            kept_view_serves(&planes->kept, shown->serial, work->request))
            return planes;
    }
    return NULL;
}

static bool is_single(const struct native_frame_state *own, const struct frame_request *request)
{
    return own->tile.width == request->width_px && own->tile.height == request->height_px;
}

struct native_view_planes *native_planes_choose(struct native_renderer *r,
                                                struct native_frame_state *own,
                                                const struct native_shown *shown,
                                                const struct frame_work *work, bool *is_kept_view)
{
    const struct frame_request *request = work->request;
    bool single = is_single(own, request), is_first = own->x == 0 && own->y == 0 && own->part == 0;
    struct native_view_planes *kept =
        is_first && (single || work->in_place) ? find_kept(r, shown, work, single) : NULL;
    *is_kept_view = kept;
    if (kept) {
        own->tile = (struct tile_size){request->width_px, request->height_px};
        return kept;
    }
    return &r->planes[single ? kept_view_is_small(request) ? NATIVE_SMALL : NATIVE_WHOLE
                             : NATIVE_APART];
}

/* The Ptex plane is always drawn here. */
static struct kept_view view_of(const struct native_shown *shown,
                                const struct frame_request *request, bool any_cut)
{
    struct kept_view view = kept_view_of(shown->serial, request);
    view.ptex = true;
    view.any_cut = view.any_cut && any_cut;
    return view;
}

/* --- tiles into one */

/* Copies the rows of the tile itself. */
static void copy_image(const struct native_drawing *d, const struct native_image *from,
                       const struct native_image *to)
{
    const struct tile *in = &d->inside;
    for (int c = 0; c < from->channels; c++)
        for (uint32_t y = in->y; y < in->y + in->height; y++)
            memcpy(to->words + (size_t)c * to->channel_words +
                       (size_t)(d->place.y + y) * (size_t)to->width + d->place.x + in->x,
                   from->words + (size_t)c * from->channel_words + (size_t)y * (size_t)from->width +
                       in->x,
                   in->width * sizeof *from->words);
}

static void copy_planes(const struct native_drawing *d, const struct native_target *to)
{
    const struct native_target *t = d->target;
    const struct native_image *const images[][2] = {
        {&t->hit_depth, &to->hit_depth}, {&t->normal, &to->normal}, {&t->shape, &to->shape},
        {&t->border, &to->border},       {&t->ptex, &to->ptex},     {&t->ends, &to->ends},
        {&t->coverage, &to->coverage}};
    for (size_t i = 0; i < sizeof images / sizeof *images; i++)
        copy_image(d, images[i][0], images[i][1]);
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

/* False if the picture's planes cannot serve another division into tiles, or memory is short. */
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

/* False if the frame's planes are not to be kept. */
static bool collect(const struct native_drawing *d, struct native_target *to)
{
    const struct native_list *groups = &d->target->list[NATIVE_SHADED_GROUPS];
    copy_planes(d, to);
    for (int i = NATIVE_GROUPS; i <= NATIVE_SHADED_GROUPS; i++)
        append(groups, &to->list[i], d->place.x / GROUP_WIDTH, d->place.y / GROUP_HEIGHT);
    if (!request_has_coverage(d->request))
        return true;
    append(&d->target->list[NATIVE_EDGES], &to->list[NATIVE_EDGES], d->place.x, d->place.y);
    return append_rounded(d, to);
}

bool native_planes_keep(struct native_renderer *r, const struct native_frame_state *own,
                        struct native_view_planes *planes, const struct native_drawing *d,
                        const struct frame_work *work, struct error *error)
{
    const struct frame_request *request = work->request;
    bool has_left_gaps = native_device_left_gaps(r->device);
    struct native_view_planes *all = &r->planes[NATIVE_TILED];
    if (is_single(own, request)) {
        bool any_cut = !has_left_gaps && (!request_has_coverage(request) ||
                                          d->target->list[NATIVE_ROUNDED].n <= ROUNDED_IN_ANY_CUT);
        planes->kept = view_of(d->shown, request, any_cut);
        return true;
    }
    if (!work->in_place || request->surface.kind != SURFACE_EXACT)
        return true;
    if (own->x == 0 && own->y == 0) {
        all->kept.model_serial = 0;
        r->collecting = own->serial;
        if (!native_target_reserve(&all->target, request->width_px, request->height_px, error))
            return false;
        for (int i = 0; i < NATIVE_LISTS; i++)
            all->target.list[i].n = 0;
    }
    if (r->collecting != own->serial)
        return true;
    bool is_last = d->place.x + d->inside.x + d->inside.width == request->width_px &&
                   d->place.y + d->inside.y + d->inside.height == request->height_px;
    if (has_left_gaps || !collect(d, &all->target))
        r->collecting = 0;
    else if (is_last)
        all->kept = view_of(d->shown, request, true);
    return true;
}
