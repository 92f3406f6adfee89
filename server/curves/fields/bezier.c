#include "server/curves/fields/bezier.h"

static const double *component(const struct vec *v, int k)
{
    return k == 0 ? &v->x : k == 1 ? &v->y : &v->z;
}

void bezier_of_patch(struct bezier *bezier, const struct limit_tables *tables,
                     const struct limit_patch *patch)
{
    /* From B-spline points to Bezier points (Farin 2002, chapter 8). */
    static const double weight[4][4] = {{1 / 6., 4 / 6., 1 / 6., 0},
                                        {0, 4 / 6., 2 / 6., 0},
                                        {0, 2 / 6., 4 / 6., 0},
                                        {0, 1 / 6., 4 / 6., 1 / 6.}};
    struct vec grid[16];
    const struct limit_node *node = patch->node;
    limit_patch_points(patch, grid);
    for (int k = 0; k < 16; k++)
        grid[k] = limit_frame_to_world(tables, node, grid[k]);
    bezier->origin = (struct vec){node->origin[0], node->origin[1], node->origin[2]};
    for (int d = 0; d < 3; d++) {
        double rows[4][4] = {{0}}; /* index along u, B-spline index along v */
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 16; k++)
                rows[i][k / 4] += weight[i][k % 4] * *component(&grid[k], d);
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                double sum = 0;
                for (int k = 0; k < 4; k++)
                    sum += weight[j][k] * rows[i][k];
                bezier->p[d][i][j] = sum;
            }
        }
    }
}

/* The cubic Bernstein polynomials at t: values, first and second derivatives. */
struct blends {
    double value[4], first[4], second[4];
};

static struct blends blends_at(double t)
{
    double r = 1 - t;
    return (struct blends){
        .value = {r * r * r, 3 * t * r * r, 3 * t * t * r, t * t * t},
        .first = {-3 * r * r, 3 * r * (1 - 3 * t), 3 * t * (2 - 3 * t), 3 * t * t},
        .second = {6 * r, 6 * (3 * t - 2), 6 * (1 - 3 * t), 6 * t},
    };
}

/* Sums the patch's points along v with each of three weights: by weights, then coordinates, then rows. */
static void weigh_rows(const struct bezier *bezier, const struct blends *v, double out[3][3][4])
{
    for (int d = 0; d < 3; d++) {
        for (int i = 0; i < 4; i++) {
            const double *p = bezier->p[d][i];
            const double *w[3] = {v->value, v->first, v->second};
            for (int k = 0; k < 3; k++)
                out[k][d][i] = w[k][0] * p[0] + w[k][1] * p[1] + w[k][2] * p[2] + w[k][3] * p[3];
        }
    }
}

static struct vec weighed(double rows[3][4], const double *u)
{
    double out[3];
    for (int d = 0; d < 3; d++)
        out[d] = u[0] * rows[d][0] + u[1] * rows[d][1] + u[2] * rows[d][2] + u[3] * rows[d][3];
    return (struct vec){out[0], out[1], out[2]};
}

void bezier_jet_at(const struct bezier *bezier, double u, double v, struct bezier_jet *out)
{
    struct blends x = blends_at(u), y = blends_at(v);
    double rows[3][3][4];
    weigh_rows(bezier, &y, rows);
    struct vec su = weighed(rows[0], x.first), sv = weighed(rows[1], x.value);
    struct vec suu = weighed(rows[0], x.second), svv = weighed(rows[2], x.value);
    struct vec suv = weighed(rows[1], x.first);
    *out = (struct bezier_jet){
        .s = {weighed(rows[0], x.value), su, sv},
        .n = {vec_cross(su, sv), vec_add(vec_cross(suu, sv), vec_cross(su, suv)),
              vec_add(vec_cross(suv, sv), vec_cross(su, svv))},
    };
}
