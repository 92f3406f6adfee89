#include "server/curves/fields/bezier.h"

#include <math.h>

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

/* The cross product of scaled nets. */
static void cross(struct net_room *room, const struct net a[3], const struct net b[3],
                  struct net out[3])
{
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        struct net plus = net_product(room, &a[e], &b[f]), minus = net_product(room, &a[f], &b[e]);
        out[d] = net_sum(room, 1, &plus, -1, &minus);
    }
}

static double largest(const struct net nets[3])
{
    double most = 0;
    for (int d = 0; d < 3; d++)
        for (size_t k = 0; k < net_size(&nets[d]); k++)
            most = fmax(most, fabs(nets[d].c[k]));
    return most;
}

/* Makes the nets from plain nets of the position and of its two derivatives. */
static void finish(struct net_room *room, struct net su[3], struct net sv[3],
                   struct bezier_nets *out)
{
    out->reach = largest(out->s);
    for (int d = 0; d < 3; d++) {
        net_scale(&out->s[d]);
        net_scale(&su[d]);
        net_scale(&sv[d]);
    }
    cross(room, su, sv, out->n);
    double most = largest(out->n);
    for (int d = 0; d < 3 && most > 0; d++)
        for (size_t k = 0; k < net_size(&out->n[d]); k++)
            out->n[d].c[k] /= most;
}

void bezier_make_nets(const struct bezier *bezier, struct net_room *room, struct bezier_nets *out)
{
    struct net su[3], sv[3];
    for (int d = 0; d < 3; d++) {
        out->s[d] = net_take(room, 3, 3);
        for (int k = 0; k < 16; k++)
            out->s[d].c[k] = bezier->p[d][k / 4][k % 4];
        su[d] = net_derivative(room, &out->s[d], 0);
        sv[d] = net_derivative(room, &out->s[d], 1);
    }
    finish(room, su, sv, out);
}

void bezier_side_nets(const struct bezier *bezier, struct net_room *room, int side,
                      struct bezier_nets *out)
{
    /* The first point of each side, and the steps along it and across it to the left. */
    static const int first[4][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
    static const int step[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    int along_u = step[side][0], along_v = step[side][1];
    struct net along[3], inward[3];
    for (int d = 0; d < 3; d++) {
        out->s[d] = net_take(room, 3, 0);
        inward[d] = net_take(room, 3, 0);
        for (int k = 0; k < 4; k++) {
            int i = first[side][0] + k * along_u, j = first[side][1] + k * along_v;
            out->s[d].c[k] = bezier->p[d][i][j];
            inward[d].c[k] = 3 * (bezier->p[d][i - along_v][j + along_u] - bezier->p[d][i][j]);
        }
        along[d] = net_derivative(room, &out->s[d], 0);
    }
    finish(room, along, inward, out);
}

static void interval_of(const struct net *scaled, double out[2])
{
    double plain[36];
    struct net net = {scaled->m, scaled->n, plain};
    size_t size = net_size(&net);
    double low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < size; k++)
        plain[k] = scaled->c[k];
    net_unscale(&net);
    for (size_t k = 0; k < size; k++) {
        low = fmin(low, plain[k]);
        high = fmax(high, plain[k]);
    }
    out[0] = 0.5 * (low + high);
    out[1] = 0.5 * (high - low);
}

void bezier_box_of(const struct bezier_nets *nets, struct bezier_box *box)
{
    for (int d = 0; d < 3; d++) {
        interval_of(&nets->s[d], box->s[d]);
        interval_of(&nets->n[d], box->n[d]);
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

/* Sums points of the patch with the products of the weights along u and v. */
static void weigh(const struct bezier *bezier, const double *u, const double *v, double out[3])
{
    for (int d = 0; d < 3; d++) {
        double sum = 0;
        for (int i = 0; i < 4; i++) {
            const double *p = bezier->p[d][i];
            sum += u[i] * (v[0] * p[0] + v[1] * p[1] + v[2] * p[2] + v[3] * p[3]);
        }
        out[d] = sum;
    }
}

static struct vec weighed(const struct bezier *bezier, const double *u, const double *v)
{
    double out[3];
    weigh(bezier, u, v, out);
    return (struct vec){out[0], out[1], out[2]};
}

void bezier_jet_at(const struct bezier *bezier, double u, double v, struct bezier_jet *out)
{
    struct blends x = blends_at(u), y = blends_at(v);
    struct vec su = weighed(bezier, x.first, y.value), sv = weighed(bezier, x.value, y.first);
    struct vec suu = weighed(bezier, x.second, y.value), svv = weighed(bezier, x.value, y.second);
    struct vec suv = weighed(bezier, x.first, y.first);
    *out = (struct bezier_jet){
        .s = {weighed(bezier, x.value, y.value), su, sv},
        .n = {vec_cross(su, sv), vec_add(vec_cross(suu, sv), vec_cross(su, suv)),
              vec_add(vec_cross(suv, sv), vec_cross(su, svv))},
    };
}
