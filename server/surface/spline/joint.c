#include "server/surface/spline/joint.h"

#include <math.h>
#include <stdbool.h>

#include "server/surface/vec.h"

/* Normals that differ by less are equal: in files with 16 digits they are, and the tables' single
 * precision has no more. */
#define EQUAL_RAD 1e-6
/* Curvatures that differ by less, relative to the larger one, are equal. They are compared in
 * double precision by the file's own points, and not by those of the tables, whose rounding makes
 * up to 2e-3. */
#define EQUAL_CURVATURE 1e-4
/* A side whose radius is above 1000 times the curve's length counts as flat
 * (server/curves/README.md, Breaks). */
#define FLAT 1e-3

/* One side of a place on the curve. */
struct side {
    struct vec normal; /* unit */
    double across;     /* curvature of the section across the curve */
    double length;     /* of the derivative along the curve */
    bool exists;       /* false: there is no normal */
};

/* Three rows of points, from the edge inwards, each in the direction of the edge. */
static void rows_of(double bezier[16][3], unsigned edge, struct vec rows[3][4])
{
    static const int first[4] = {0, 3, 15, 12}, along[4] = {1, 4, -1, -4},
                     inwards[4] = {4, -1, -4, 1};
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 4; i++) {
            const double *p = bezier[first[edge] + i * along[edge] + j * inwards[edge]];
            rows[j][i] = (struct vec){p[0], p[1], p[2]};
        }
}

static struct vec weighed(const struct vec *p, int n, const double *weight)
{
    struct vec sum = {0, 0, 0};
    for (int i = 0; i < n; i++)
        sum = vec_mad(sum, weight[i], p[i]);
    return sum;
}

static struct side side_at(struct vec rows[3][4], double t)
{
    const double r = 1 - t;
    const double value[4] = {r * r * r, 3 * r * r * t, 3 * r * t * t, t * t * t};
    const double slope[3] = {3 * r * r, 6 * r * t, 3 * t * t}, bend[2] = {6 * r, 6 * t};
    struct vec step[3], turn[2], in[4], in_step[3], in_turn[4];
    for (int i = 0; i < 4; i++) {
        in[i] = vec_scale(vec_sub(rows[1][i], rows[0][i]), 3);
        struct vec second =
            vec_sub(vec_sub(rows[2][i], rows[1][i]), vec_sub(rows[1][i], rows[0][i]));
        in_turn[i] = vec_scale(second, 6);
    }
    for (int i = 0; i < 3; i++) {
        step[i] = vec_sub(rows[0][i + 1], rows[0][i]);
        in_step[i] = vec_sub(in[i + 1], in[i]);
    }
    for (int i = 0; i < 2; i++)
        turn[i] = vec_sub(step[i + 1], step[i]);
    const struct vec st = weighed(step, 3, slope), sn = weighed(in, 4, value);
    const struct vec normal = vec_cross(st, sn);
    const double area = vec_length(normal), length = vec_length(st);
    struct side side = {.length = length,
                        .exists = area > 1e-9 * length * vec_length(sn) && area > 0};
    if (!side.exists)
        return side;
    side.normal = vec_scale(normal, 1 / area);
    /* sn = a e + b x with e along the curve and x across it. */
    const double a = vec_dot(sn, st) / length, b = area / length;
    const double ee = vec_dot(weighed(turn, 2, bend), side.normal) / (length * length);
    const double ex = (vec_dot(weighed(in_step, 3, slope), side.normal) / length - a * ee) / b;
    const double nn = vec_dot(weighed(in_turn, 4, value), side.normal);
    side.across = (nn - a * a * ee - 2 * a * b * ex) / (b * b);
    return side;
}

enum joint_kind joint_kind_of(double a[16][3], unsigned a_edge, double b[16][3], unsigned b_edge)
{
    static const double places[9] = {0, 1.0 / 64, 0.125, 0.3, 0.5, 0.7, 0.875, 63.0 / 64, 1};
    struct vec a_rows[3][4], b_rows[3][4];
    enum joint_kind kind = JOINT_SMOOTH;
    int n = 0;
    rows_of(a, a_edge, a_rows);
    rows_of(b, b_edge, b_rows);
    for (int i = 0; i < 9; i++) {
        const struct side p = side_at(a_rows, places[i]), q = side_at(b_rows, 1 - places[i]);
        if (!p.exists || !q.exists)
            continue; /* a pole at an end of the curve */
        n++;
        if (!(vec_dot(p.normal, q.normal) > 0) ||
            !(vec_length(vec_cross(p.normal, q.normal)) <= EQUAL_RAD))
            return JOINT_CREASE;
        double largest = fmax(fabs(p.across), fabs(q.across));
        if (!(fabs(p.across - q.across) <= EQUAL_CURVATURE * fmax(largest, FLAT / p.length)))
            kind = JOINT_BEND;
    }
    return n > 0 ? kind : JOINT_CREASE;
}
