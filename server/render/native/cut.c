/* Pieces that the near plane cuts, or that reach far beyond the picture: their triangles, cut in
 * double to what can be drawn. */
#include "server/render/native/frame.h"
#include "server/render/native/tile.h"

#include <math.h>

#include "server/surface/evaluate.h"

/* Beyond the picture triangles are cut off. */
static const double MARGIN_PX = 64;
/* Each plane adds a corner at most. */
enum { PLANES = 5, MOST_CORNERS = 3 + PLANES };

/* In camera space, and on the piece. */
struct corner {
    double at[3], s, t;
};

/* What lies on its inner side is at least 0. */
struct plane {
    double normal[3], offset;
};

static double above(const struct plane *plane, const struct corner *c)
{
    return plane->normal[0] * c->at[0] + plane->normal[1] * c->at[1] + plane->normal[2] * c->at[2] +
           plane->offset;
}

/* The near plane first: what is left of it has a place in the picture. */
static void planes_of(const struct view *view, struct plane planes[PLANES])
{
    const double size[2] = {view->width_px, view->height_px};
    planes[0] = (struct plane){{0, 0, 1}, -view->near};
    for (int k = 0; k < 2; k++) {
        double low = (view->centre_px[k] + MARGIN_PX) * view->units_per_px;
        double high = (size[k] - view->centre_px[k] + MARGIN_PX) * view->units_per_px;
        struct plane *first = &planes[1 + 2 * k], *second = first + 1;
        *first = (struct plane){{0, 0, view->perspective ? low : 0}, view->perspective ? 0 : low};
        *second =
            (struct plane){{0, 0, view->perspective ? high : 0}, view->perspective ? 0 : high};
        first->normal[k] = 1;
        second->normal[k] = -1;
    }
}

static struct corner between(const struct corner *a, const struct corner *b, double share)
{
    struct corner c = {.s = a->s + share * (b->s - a->s), .t = a->t + share * (b->t - a->t)};
    for (int k = 0; k < 3; k++)
        c.at[k] = a->at[k] + share * (b->at[k] - a->at[k]);
    return c;
}

/* What a plane leaves of a convex polygon. */
static int cut(const struct plane *plane, const struct corner *in, int n, struct corner *out)
{
    int left = 0;
    for (int i = 0; i < n; i++) {
        const struct corner *a = &in[i], *b = &in[(i + 1) % n];
        double up_a = above(plane, a), up_b = above(plane, b);
        if (up_a >= 0)
            out[left++] = *a;
        if ((up_a >= 0) != (up_b >= 0))
            out[left++] = between(a, b, up_a / (up_a - up_b));
    }
    return left;
}

static void set_corner(const struct native_frame *frame, const struct corner *c, int k,
                       struct native_triangle *triangle)
{
    const struct view *view = frame->view;
    double z = c->at[2],
           scale = 1 / (view->perspective ? z * view->units_per_px : view->units_per_px);
    double before = view->far - z;
    triangle->x[k] = (float)(c->at[0] * scale + view->centre_px[0]);
    triangle->y[k] = (float)(c->at[1] * scale + view->centre_px[1]);
    triangle->nearness[k] = (float)(view->perspective ? before / z : before);
    triangle->inverse_z[k] = (float)(view->perspective ? view->near / z : 1);
    triangle->s[k] = (float)c->s;
    triangle->t[k] = (float)c->t;
}

/* Box of pixels' centres, x0, y0, x1, y1, of what has been added so far. */
static void widen(const struct native_triangle *t, int box[4], float *nearest)
{
    for (int k = 0; k < 3; k++) {
        box[0] = (int)fminf((float)box[0], floorf(t->x[k] - 0.5f));
        box[1] = (int)fminf((float)box[1], floorf(t->y[k] - 0.5f));
        box[2] = (int)fmaxf((float)box[2], ceilf(t->x[k] - 0.5f));
        box[3] = (int)fmaxf((float)box[3], ceilf(t->y[k] - 0.5f));
        *nearest = fmaxf(*nearest, t->nearness[k]);
    }
}

/* What is left of a triangle. Returns how many; -1: no memory. */
static int add_triangle(const struct native_frame *frame, struct native_thread *thread,
                        const struct plane planes[PLANES], const struct corner corners[3],
                        int box[4], float *nearest)
{
    struct corner a[MOST_CORNERS + 1], b[MOST_CORNERS + 1], *in = a, *out = b;
    int n = 3;
    for (int k = 0; k < 3; k++)
        in[k] = corners[k];
    for (int p = 0; p < PLANES && n; p++) {
        n = cut(&planes[p], in, n, out);
        struct corner *swap = in;
        in = out;
        out = swap;
    }
    if (n < 3)
        return 0;
    if (!native_grow(&thread->triangle, &thread->triangle_capacity,
                     thread->n_triangles + (size_t)n - 2, sizeof *thread->triangle))
        return -1;
    for (int k = 2; k < n; k++) {
        struct native_triangle *triangle = &thread->triangle[thread->n_triangles++];
        set_corner(frame, &in[0], 0, triangle);
        set_corner(frame, &in[k - 1], 1, triangle);
        set_corner(frame, &in[k], 2, triangle);
        widen(triangle, box, nearest);
    }
    return n - 2;
}

/* A place of the piece in camera space; s, t in [0,1]. */
static struct corner corner_at(const struct native_frame *frame, const struct native_piece *piece,
                               double s, double t)
{
    const struct limit_tables *tables = frame->model->tables;
    struct limit_place place = {piece->node, tables->nodes[piece->node].rotation, 0, 0};
    struct limit_point point = {0};
    struct corner corner = {.s = s, .t = t};
    native_place(tables, piece, s, t, &place.a, &place.b);
    limit_evaluate_at(tables, &place, &point);
    const double world[3] = {point.s.x, point.s.y, point.s.z};
    view_transform(frame->view, world, corner.at);
    return corner;
}

static void cut_to_picture(const struct view *view, int box[4])
{
    int width = (int)view->width_px, height = (int)view->height_px;
    box[0] = box[0] < 0 ? 0 : box[0];
    box[1] = box[1] < 0 ? 0 : box[1];
    box[2] = box[2] < width ? box[2] : width - 1;
    box[3] = box[3] < height ? box[3] : height - 1;
}

int native_cut_piece(const struct native_frame *frame, struct native_thread *thread,
                     const struct native_piece *piece, uint32_t grid, int box[4], float *nearest)
{
    int across = grid_cells[grid / GRID_SIDES], down = grid_cells[grid % GRID_SIDES], total = 0;
    struct corner row[2][65];
    struct plane planes[PLANES];
    planes_of(frame->view, planes);
    box[0] = box[1] = UINT16_MAX;
    box[2] = box[3] = -1;
    *nearest = 0;
    for (int j = 0; j <= down; j++) {
        struct corner *own = row[j & 1], *last = row[~j & 1];
        for (int i = 0; i <= across; i++)
            own[i] = corner_at(frame, piece, (double)i / across, (double)j / down);
        for (int i = 0; i < across && j > 0; i++) {
            const struct corner halves[2][3] = {{last[i], last[i + 1], own[i]},
                                                {own[i], last[i + 1], own[i + 1]}};
            for (int k = 0; k < 2; k++) {
                int n = add_triangle(frame, thread, planes, halves[k], box, nearest);
                if (n < 0)
                    return -1;
                total += n;
            }
        }
    }
    cut_to_picture(frame->view, box);
    return box[0] <= box[2] && box[1] <= box[3] ? total : 0;
}
