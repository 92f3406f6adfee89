/* Folds of known angle and joints of known curvature as limit tables, and the search for breaks on them: for the unit
 * tests of server/curves/breaks. */
#ifndef SHEEN_TESTS_UNIT_BREAK_CAGES_H
#define SHEEN_TESTS_UNIT_BREAK_CAGES_H

#include "server/curves/breaks/breaks.h"
#include "server/curves/computation.h"
#include "tests/unit/cage_tables.h"

/* A light in the plane z = 30, and an eye that sees the surface from obliquely above. */
static struct light LIGHT = {.kind = LIGHT_PLANE,
                             .centre = {0.5, -1, 30},
                             .u = {1, 0.2, 0},
                             .v = {-0.3, 1, 0},
                             .pattern = {.kind = PATTERN_STRIPES, .period = 0.25, .duty = 0.5}};
static struct lines LINES = {
    .family = LINES_REFLECTION, .eye_kind = LINE_EYE_POINT, .eye = {3, -5, 20}};
static const struct break_limits LIMITS = {1e-4, 0.1, 10};

static inline struct computation *start(const struct limit_tables *tables,
                                        const struct break_limits *limits)
{
    const struct break_lines lines = {&LINES, &LIGHT, 1};
    struct error error = {0};
    struct computation *computation = breaks_create(tables, &lines, limits, &error);
    assert_non_null(computation);
    return computation;
}

static inline struct computation *find(const struct limit_tables *tables)
{
    struct error error = {0};
    struct computation *computation = start(tables, &LIMITS);
    assert_true(computation_run(computation, &error));
    return computation;
}

/* --- cages */

/* A sheet of 4 x n faces of side 1 that is folded along x = 0 by `angle` radians, with an infinitely sharp crease
 * along the first n_creased edges of the fold. */
static inline void build_fold(double angle, int n, int n_creased, double sharpness,
                              struct limit_tables *tables)
{
    static char text[20000];
    int used = 0;
    for (int y = 0; y <= n; y++)
        for (int x = -2; x <= 2; x++)
            used += sprintf(text + used, "v %.17g %d %.17g\n", x <= 0 ? x : x * cos(angle), y,
                            x <= 0 ? 0 : x * sin(angle));
    for (int y = 0; y < n; y++)
        for (int x = 0; x < 4; x++) {
            int a = 5 * y + x + 1;
            used += sprintf(text + used, "f %d %d %d %d\n", a, a + 1, a + 6, a + 5);
        }
    for (int y = 0; y < n_creased; y++)
        used += sprintf(text + used, "t crease 2/1/0 %d %d %g\n", 5 * y + 2, 5 * y + 7, sharpness);
    build(text, (size_t)used, tables);
}

/* The B-spline points of the quadratic z = a x^2 / 2 + b x y + c y^2 / 2 + d on the unit square at x = left: a quadratic is
 * reproduced if from each point's height the third of the second derivatives is taken. Faces other than the middle one
 * have no surface. */
struct quadratic {
    double a, b, c, d;
};

static inline int add_patch(char *text, int used, int first, double left, const struct quadratic *q,
                            bool turned_over)
{
    for (int j = -1; j <= 2; j++)
        for (int i = -1; i <= 2; i++) {
            double x = left + i, y = j;
            used += sprintf(text + used, "v %.17g %.17g %.17g\n", x, y,
                            q->a * (x * x - 1.0 / 3) / 2 + q->b * x * y +
                                q->c * (y * y - 1.0 / 3) / 2 + q->d);
        }
    for (int k = 1; k <= 11; k++)
        if (k % 4)
            used += turned_over ? sprintf(text + used, "f %d %d %d %d\n", first + k, first + k + 4,
                                          first + k + 5, first + k + 1)
                                : sprintf(text + used, "f %d %d %d %d\n", first + k, first + k + 1,
                                          first + k + 5, first + k + 4);
    return used;
}

/* Two patches side by side, which meet at x = 0. */
static inline void build_joint(const struct quadratic *left, const struct quadratic *right,
                               bool turned_over, struct limit_tables *tables)
{
    static char text[10000];
    int used = add_patch(text, 0, 0, -1, left, false);
    used = add_patch(text, used, 16, 0, right, turned_over);
    used += sprintf(text + used, "t interpolateboundary 1/0/0 0\n");
    build(text, (size_t)used, tables);
}

static inline const struct break_worst *worst(const struct breaks_found *result, size_t i,
                                              enum break_measure measure)
{
    return &result->edges[i].worst[measure];
}

#endif
