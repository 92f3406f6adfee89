/* Draws pieces that the near plane cuts or that reach far beyond the picture: cuts their triangles in double
 * precision to what can be drawn. */
#include "server/render/native/clip/clip.h"
#include "server/render/native/frame.h"
#include "server/render/native/tile.h"

#include <math.h>

#include "server/surface/evaluate.h"

static void set_corner(const struct native_frame *frame, const struct native_corner *c, int k,
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

/* Widens the box of pixels' centres, x0, y0, x1, y1, by a triangle. */
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

/* Adds what remains of a triangle. Returns the number of triangles; -1: no memory. */
static int add_triangle(const struct native_frame *frame, struct native_thread *thread,
                        const struct native_clip *clip, const struct native_corner corners[3],
                        int box[4], float *nearest)
{
    struct native_corner left[CLIP_MOST_CORNERS];
    int n = native_clip_triangle(clip, corners, left);
    if (n == 0)
        return 0;
    if (!native_grow(&thread->triangle, &thread->triangle_capacity,
                     thread->n_triangles + (size_t)n - 2, sizeof *thread->triangle))
        return -1;
    for (int k = 2; k < n; k++) {
        struct native_triangle *triangle = &thread->triangle[thread->n_triangles++];
        set_corner(frame, &left[0], 0, triangle);
        set_corner(frame, &left[k - 1], 1, triangle);
        set_corner(frame, &left[k], 2, triangle);
        widen(triangle, box, nearest);
    }
    return n - 2;
}

/* A point of the piece in camera space; s, t in [0,1]. */
static struct native_corner corner_at(const struct native_frame *frame,
                                      const struct native_piece *piece, double s, double t)
{
    const struct limit_tables *tables = frame->model->tables;
    struct limit_place place = {piece->node, tables->nodes[piece->node].rotation, 0, 0};
    struct limit_point point = {0};
    struct native_corner corner = {.s = s, .t = t};
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

/* A vertex that is computed here, in double precision and with its patch searched for, takes as long as so many
 * others. */
enum { CUT_VERTEX_WEIGHT = 16 };

/* Counts the vertices of a grid, so that views that cut very many pieces are refused, as others with too many vertices
 * are. False if they are too many. */
static bool count_vertices(struct native_frame *frame, int across, int down)
{
    uint64_t n = (uint64_t)(across + 1) * (uint64_t)(down + 1) * CUT_VERTEX_WEIGHT;
    if (__atomic_add_fetch(&frame->n_vertices, n, __ATOMIC_RELAXED) > GRIDS_MAX_VERTICES)
        __atomic_store_n(&frame->too_many, true, __ATOMIC_RELAXED);
    return !__atomic_load_n(&frame->too_many, __ATOMIC_RELAXED);
}

int native_cut_piece(struct native_frame *frame, struct native_thread *thread,
                     const struct native_piece *piece, uint32_t grid, int box[4], float *nearest)
{
    int across = grid_cells[grid / GRID_SIDES], down = grid_cells[grid % GRID_SIDES], total = 0;
    if (!count_vertices(frame, across, down))
        return 0;
    struct native_corner row[2][65];
    struct native_clip clip;
    native_clip_init(&clip, frame->view);
    box[0] = box[1] = UINT16_MAX;
    box[2] = box[3] = -1;
    *nearest = 0;
    for (int j = 0; j <= down; j++) {
        struct native_corner *own = row[j & 1], *last = row[~j & 1];
        for (int i = 0; i <= across; i++)
            own[i] = corner_at(frame, piece, (double)i / across, (double)j / down);
        for (int i = 0; i < across && j > 0; i++) {
            const struct native_corner halves[2][3] = {{last[i], last[i + 1], own[i]},
                                                       {own[i], last[i + 1], own[i + 1]}};
            for (int k = 0; k < 2; k++) {
                int n = add_triangle(frame, thread, &clip, halves[k], box, nearest);
                if (n < 0)
                    return -1;
                total += n;
            }
        }
    }
    cut_to_picture(frame->view, box);
    return box[0] <= box[2] && box[1] <= box[3] ? total : 0;
}
