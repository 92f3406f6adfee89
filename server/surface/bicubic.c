#include "server/surface/bicubic.h"

#include <string.h>

#include "server/surface/texels.h"

void bicubic_read(const struct bicubic_points *points, struct vec grid[16])
{
    for (int j = 0; j < 4; j++) {
        if (points->exact)
            memcpy(grid + 4 * j, points->exact + points->stride * j, 4 * sizeof *grid);
        else
            texels_read_row(points->rows + 3 * j, points->scale, grid + 4 * j);
    }
    if (points->exact || !points->column)
        return;
    struct vec first[4];
    texels_read_row(points->column, points->scale, first);
    for (int j = 0; j < 4; j++) {
        memmove(grid + 4 * j + 1, grid + 4 * j, 3 * sizeof *grid);
        grid[4 * j] = first[j];
    }
}

/* The four uniform cubic B-splines at t: values, first and second derivatives. */
struct blends {
    double value[4], first[4], second[4];
};

static struct blends blends_at(double t)
{
    double r = 1 - t;
    return (struct blends){
        .value = {r * r * r / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + r * r * (3 * r - 6)) / 6,
                  t * t * t / 6},
        .first = {-r * r / 2, t * (3 * t - 4) / 2, -r * (3 * r - 4) / 2, t * t / 2},
        .second = {r, 3 * t - 2, 3 * r - 2, t},
    };
}

void bicubic_evaluate(const struct bicubic_points *points, double s, double t,
                      struct bicubic_point *out)
{
    struct blends x = blends_at(s), y = blends_at(t);
    struct vec grid[16];
    bicubic_read(points, grid);
    *out = (struct bicubic_point){0};
    for (int k = 0; k < 16; k++) {
        int i = k & 3, j = k >> 2;
        struct vec p = grid[k];
        out->p = vec_mad(out->p, x.value[i] * y.value[j], p);
        out->ps = vec_mad(out->ps, x.first[i] * y.value[j], p);
        out->pt = vec_mad(out->pt, x.value[i] * y.first[j], p);
        out->pss = vec_mad(out->pss, x.second[i] * y.value[j], p);
        out->pst = vec_mad(out->pst, x.first[i] * y.first[j], p);
        out->ptt = vec_mad(out->ptt, x.value[i] * y.second[j], p);
    }
}

/* The control points of the part [a, b] of a segment on [0, 1], whose own points are `stride`
 * apart, by blossoms at the finer knots (Ramshaw 1989). */
static void cut_segment(const struct vec *p, int stride, double a, double b, struct vec out[4])
{
    double h = b - a;
    const double knots[4][3] = {
        {a - 2 * h, a - h, a}, {a - h, a, b}, {a, b, b + h}, {b, b + h, b + 2 * h}};
    for (int i = 0; i < 4; i++) {
        double r = knots[i][0], s = knots[i][1], t = knots[i][2];
        struct vec q[3], e[2];
        for (int k = 0; k < 3; k++) {
            double w = (r + 2 - k) / 3;
            q[k] = vec_mad(vec_scale(p[k * stride], 1 - w), w, p[(k + 1) * stride]);
        }
        for (int k = 0; k < 2; k++) {
            double w = (s + 1 - k) / 2;
            e[k] = vec_mad(vec_scale(q[k], 1 - w), w, q[k + 1]);
        }
        out[i] = vec_mad(vec_scale(e[0], 1 - t), t, e[1]);
    }
}

void bicubic_cut(const struct vec grid[16], double s, double t, double size, struct vec out[16])
{
    struct vec rows[16];
    for (int j = 0; j < 4; j++)
        cut_segment(grid + 4 * j, 1, s, s + size, rows + 4 * j);
    for (int i = 0; i < 4; i++) {
        struct vec column[4];
        cut_segment(rows + i, 4, t, t + size, column);
        for (int j = 0; j < 4; j++)
            out[4 * j + i] = column[j];
    }
}
