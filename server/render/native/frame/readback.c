#include "server/render/native/frame/readback.h"

#include <math.h>
#include <string.h>

/* A row of the tile: its pixels in the target and in the frame. */
struct row {
    size_t from, to, n;
    uint32_t x, y; /* px of the picture where it begins */
};

/* Interleaves planes. */
static void put_channels(void *plane, const struct native_image *image, const struct row *row)
{
    uint32_t *to = (uint32_t *)plane + row->to * (size_t)image->channels;
    if (image->channels == 1) {
        memcpy(to, image->words + row->from, row->n * sizeof *to);
        return;
    }
    for (size_t i = 0; i < row->n; i++)
        for (int c = 0; c < image->channels; c++)
            *to++ = image->words[(size_t)c * image->channel_words + row->from + i];
}

static void put_position(void *plane, const float *depth, const struct view *view,
                         const struct row *row)
{
    float(*to)[3] = (float(*)[3])plane + row->to;
    for (size_t i = 0; i < row->n; i++) {
        float z = depth[row->from + i];
        if (z > 0)
            view_position(view, row->x + (uint32_t)i, row->y, (double)z, to[i]);
        else
            to[i][0] = to[i][1] = to[i][2] = NAN;
    }
}

/* A normal of 0 marks a place without one (a cone's tip). */
static void put_normal(void *plane, const struct native_planes *planes, const struct row *row)
{
    float(*to)[3] = (float(*)[3])plane + row->to;
    for (size_t i = 0; i < row->n; i++) {
        size_t at = row->from + i;
        const float n[3] = {planes->normal[0][at], planes->normal[1][at], planes->normal[2][at]};
        bool there = planes->depth[at] > 0 && (n[0] != 0 || n[1] != 0 || n[2] != 0);
        for (int k = 0; k < 3; k++)
            to[i][k] = there ? n[k] : NAN;
    }
}

/* Pixels that show nothing get no face. */
static void put_ptex(void *plane, const struct native_planes *planes, const struct row *row)
{
    uint32_t(*to)[3] = (uint32_t(*)[3])plane + row->to;
    for (size_t i = 0; i < row->n; i++) {
        size_t at = row->from + i;
        bool there = planes->depth[at] > 0;
        float uv[2] = {there ? planes->u[at] : 0, there ? planes->v[at] : 0};
        to[i][0] = there ? planes->face[at] : UINT32_MAX;
        memcpy(&to[i][1], uv, sizeof uv);
    }
}

static void put_row(const struct native_drawing *d, const struct view *view, struct frame *frame,
                    const struct row *row)
{
    const struct native_target *t = d->target;
    const struct {
        int plane;
        const struct native_image *image;
    } as_they_are[] = {{0, &t->colour},
                       {4, &t->light_st},
                       {5, &t->curvature},
                       {6, &t->light_change},
                       {7, &t->coverage}};
    for (size_t i = 0; i < sizeof as_they_are / sizeof *as_they_are; i++)
        if (frame->plane[as_they_are[i].plane])
            put_channels(frame->plane[as_they_are[i].plane], as_they_are[i].image, row);
    if (frame->plane[1])
        put_position(frame->plane[1], t->planes.depth, view, row);
    if (frame->plane[2])
        put_normal(frame->plane[2], &t->planes, row);
    if (frame->plane[3])
        put_ptex(frame->plane[3], &t->planes, row);
}

struct reading {
    const struct native_drawing *drawing;
    const struct view *view;
    struct frame *frame;
};

static void put_rows(void *owner, uint32_t first, uint32_t end)
{
    const struct reading *reading = owner;
    const struct native_drawing *d = reading->drawing;
    const struct view_part part = view_part_of(d->request);
    for (uint32_t y = first; y < end; y++) {
        struct row row = {
            .x = d->place.x + d->inside.x, .y = d->place.y + d->inside.y + y, .n = d->inside.width};
        row.from = (size_t)(d->inside.y + y) * d->target->width + d->inside.x;
        row.to = (size_t)(row.y - part.y) * reading->frame->width_px + row.x - part.x;
        put_row(d, reading->view, reading->frame, &row);
    }
}

void native_readback(const struct native_drawing *d, const struct view *view, struct frame *frame)
{
    struct reading reading = {d, view, frame};
    native_device_rows(d->device, d->inside.height, put_rows, &reading);
}
