#include "client/cli/lines/cubics.h"

#include <math.h>
#include <stdbool.h>

static double distance(const double a[2], const double b[2])
{
    return hypot(b[0] - a[0], b[1] - a[1]);
}

/* The length of the polyline from point i to k. */
static double length_of(const struct plane_point *points, size_t i, size_t k)
{
    double length = 0;
    for (; i < k; i++)
        length += distance(points[i].at, points[i + 1].at);
    return length;
}

/* The piece between two points; a third of the length is the handle. */
static struct cubic cubic_between(const struct plane_point *a, const struct plane_point *b,
                                  double length)
{
    struct cubic cubic;
    const struct plane_point *ends[2] = {a, b};
    for (int e = 0; e < 2; e++) {
        const double *along = ends[e]->along;
        double size = hypot(along[0], along[1]), sign = e ? -1 : 1;
        for (int i = 0; i < 2; i++) {
            double chord = (b->at[i] - a->at[i]) / 3;
            double handle = size > 0 ? along[i] / size * length / 3 : chord;
            cubic.control[3 * e][i] = ends[e]->at[i];
            cubic.control[e ? 2 : 1][i] = ends[e]->at[i] + sign * handle;
        }
    }
    return cubic;
}

/* Position and first derivative at t. */
static void evaluate(const struct cubic *cubic, double t, double at[2], double slope[2])
{
    double r = 1 - t;
    for (int i = 0; i < 2; i++) {
        const double p[4] = {cubic->control[0][i], cubic->control[1][i], cubic->control[2][i],
                             cubic->control[3][i]};
        at[i] = r * r * r * p[0] + 3 * r * r * t * p[1] + 3 * r * t * t * p[2] + t * t * t * p[3];
        slope[i] = 3 * (r * r * (p[1] - p[0]) + 2 * r * t * (p[2] - p[1]) + t * t * (p[3] - p[2]));
    }
}

/* The distance of a point from the piece near t: two steps of Gauss and Newton. */
static double distance_from(const struct cubic *cubic, double t, const double point[2])
{
    double at[2], slope[2];
    for (int i = 0; i < 2; i++) {
        evaluate(cubic, t, at, slope);
        double square = slope[0] * slope[0] + slope[1] * slope[1];
        if (square > 0)
            t += ((point[0] - at[0]) * slope[0] + (point[1] - at[1]) * slope[1]) / square;
        t = fmin(fmax(t, 0), 1);
    }
    evaluate(cubic, t, at, slope);
    return distance(at, point);
}

/* Whether one piece from point i to k is within the tolerance of all points between. */
static bool fits(const struct plane_point *points, size_t i, size_t k, double tolerance,
                 struct cubic *cubic)
{
    double whole = length_of(points, i, k), length = 0;
    *cubic = cubic_between(&points[i], &points[k], whole);
    for (size_t j = i + 1; j < k; j++) {
        length += distance(points[j - 1].at, points[j].at);
        /* A cubic with such handles deviates from the line at most where it turns back. */
        const double *along = points[j].along;
        double forward = along[0] * (points[j + 1].at[0] - points[j - 1].at[0]) +
                         along[1] * (points[j + 1].at[1] - points[j - 1].at[1]);
        if (forward < 0 || distance_from(cubic, length / whole, points[j].at) > tolerance)
            return false;
    }
    return true;
}

size_t cubics_fit(const struct plane_point *points, size_t n, double tolerance,
                  struct cubic *cubics)
{
    enum { MOST_POINTS = 64 }; /* of one piece */
    size_t n_cubics = 0;
    for (size_t i = 0; i + 1 < n;) {
        struct cubic longer;
        size_t k = i + 1;
        fits(points, i, k, tolerance, &cubics[n_cubics]);
        while (k + 1 < n && k < i + MOST_POINTS && fits(points, i, k + 1, tolerance, &longer)) {
            cubics[n_cubics] = longer;
            k++;
        }
        n_cubics++;
        i = k;
    }
    return n_cubics;
}
