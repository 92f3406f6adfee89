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

/* Number of cells along the sides of a block: the cells of a block are computed only if it may be in the picture. */
enum { BLOCK = 8 };

/* A piece that is being cut. */
struct cutting {
    struct native_frame *frame;
    struct native_thread *thread;
    const struct native_piece *piece;
    int across, down; /* cells of its grid */
    struct native_clip clip;
    struct limit_patch patch; /* of the latest vertex, so that its points need not be made again */
    /* How far the surface may lie from the bilinear interpolation of a block's corners, units; INFINITY: not known. */
    double off;
    int *box;
    float *nearest;
};

/* Adds what remains of a triangle. Returns the number of triangles; -1: no memory. */
static int add_triangle(const struct cutting *of, const struct native_corner corners[3])
{
    struct native_thread *thread = of->thread;
    struct native_corner left[CLIP_MOST_CORNERS];
    int n = native_clip_triangle(&of->clip, corners, left);
    if (n == 0)
        return 0;
    if (!native_grow(&thread->triangle, &thread->triangle_capacity,
                     thread->n_triangles + (size_t)n - 2, sizeof *thread->triangle))
        return -1;
    for (int k = 2; k < n; k++) {
        struct native_triangle *triangle = &thread->triangle[thread->n_triangles++];
        set_corner(of->frame, &left[0], 0, triangle);
        set_corner(of->frame, &left[k - 1], 1, triangle);
        set_corner(of->frame, &left[k], 2, triangle);
        widen(triangle, of->box, of->nearest);
    }
    return n - 2;
}

/* Vertex (i,j) of the grid in camera space. */
static struct native_corner vertex_at(struct cutting *of, int i, int j)
{
    const struct limit_tables *tables = of->frame->model->tables;
    const struct native_piece *piece = of->piece;
    struct limit_place place = {piece->node, tables->nodes[piece->node].rotation, 0, 0};
    struct limit_point point = {0};
    struct native_corner corner = {.s = (double)i / of->across, .t = (double)j / of->down};
    native_place(tables, piece, corner.s, corner.t, &place.a, &place.b);
    if (limit_patch_find_again(tables, &place, &of->patch))
        limit_patch_evaluate(tables, &of->patch, &point);
    const double world[3] = {point.s.x, point.s.y, point.s.z};
    view_transform(of->frame->view, world, corner.at);
    return corner;
}

/* A vertex that is computed here, in double precision and with its patch searched for, takes as long as so many
 * others. */
enum { CUT_VERTEX_WEIGHT = 16 };

/* Counts the vertices of so many cells, so that views that cut very many pieces are refused, as others with too many
 * vertices are. False if they are too many. */
static bool count_vertices(struct native_frame *frame, int across, int down)
{
    uint64_t n = (uint64_t)(across + 1) * (uint64_t)(down + 1) * CUT_VERTEX_WEIGHT;
    if (__atomic_add_fetch(&frame->n_vertices, n, __ATOMIC_RELAXED) > GRIDS_MAX_VERTICES)
        __atomic_store_n(&frame->too_many, true, __ATOMIC_RELAXED);
    return !__atomic_load_n(&frame->too_many, __ATOMIC_RELAXED);
}

/* Cells from (i0,j0) to (i1,j1). Returns the number of triangles; -1: no memory. */
static int cut_cells(struct cutting *of, int i0, int j0, int i1, int j1)
{
    struct native_corner row[2][BLOCK + 1];
    int total = 0;
    for (int j = j0; j <= j1; j++) {
        struct native_corner *own = row[j & 1], *last = row[~j & 1];
        for (int i = i0; i <= i1; i++)
            own[i - i0] = vertex_at(of, i, j);
        for (int k = 0; k < i1 - i0 && j > j0; k++) {
            const struct native_corner halves[2][3] = {{last[k], last[k + 1], own[k]},
                                                       {own[k], last[k + 1], own[k + 1]}};
            for (int h = 0; h < 2; h++) {
                int n = add_triangle(of, halves[h]);
                if (n < 0)
                    return -1;
                total += n;
            }
        }
    }
    return total;
}

static int cut_block(struct cutting *of, int i0, int j0)
{
    if (!count_vertices(of->frame, 1, 1)) /* its corners */
        return 0;
    int i1 = i0 + BLOCK < of->across ? i0 + BLOCK : of->across;
    int j1 = j0 + BLOCK < of->down ? j0 + BLOCK : of->down;
    const struct native_corner corners[4] = {vertex_at(of, i0, j0), vertex_at(of, i1, j0),
                                             vertex_at(of, i0, j1), vertex_at(of, i1, j1)};
    if (native_clip_excludes(&of->clip, corners, 4, of->off) ||
        !count_vertices(of->frame, i1 - i0, j1 - j0))
        return 0;
    return cut_cells(of, i0, j0, i1, j1);
}

static void cut_to_picture(const struct view *view, int box[4])
{
    int width = (int)view->width_px, height = (int)view->height_px;
    box[0] = box[0] < 0 ? 0 : box[0];
    box[1] = box[1] < 0 ? 0 : box[1];
    box[2] = box[2] < width ? box[2] : width - 1;
    box[3] = box[3] < height ? box[3] : height - 1;
}

/* See cutting.off: second derivatives bound it. The patch has single precision. */
static double off_of_block(const struct native_patch *patch, const struct native_piece *piece,
                           int across, int down)
{
    const double up = 1.001;
    if (!patch)
        return INFINITY;
    double side = (double)piece->size * fmin(1, (double)BLOCK / (across < down ? across : down));
    return up * (double)patch->bend * (double)patch->scale * side * side / 8;
}

int native_cut_piece(struct native_frame *frame, struct native_thread *thread,
                     const struct native_piece *piece, const struct native_patch *patch,
                     uint32_t grid, int box[4], float *nearest)
{
    struct cutting of = {.frame = frame,
                         .thread = thread,
                         .piece = piece,
                         .across = grid_cells[grid / GRID_SIDES],
                         .down = grid_cells[grid % GRID_SIDES],
                         .box = box,
                         .nearest = nearest};
    int total = 0;
    of.off = off_of_block(patch, piece, of.across, of.down);
    native_clip_init(&of.clip, frame->view);
    box[0] = box[1] = UINT16_MAX;
    box[2] = box[3] = -1;
    *nearest = 0;
    for (int j = 0; j < of.down; j += BLOCK)
        for (int i = 0; i < of.across; i += BLOCK) {
            int n = cut_block(&of, i, j);
            if (n < 0)
                return -1;
            total += n;
        }
    cut_to_picture(frame->view, box);
    return box[0] <= box[2] && box[1] <= box[3] ? total : 0;
}
