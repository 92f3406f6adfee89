#include "server/render/native/frame/kept.h"

#include "server/render/native/frame/collect.h"

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
    if (has_left_gaps || !native_collect(d, &all->target))
        r->collecting = 0;
    else if (is_last)
        all->kept = view_of(d->shown, request, true);
    return true;
}
