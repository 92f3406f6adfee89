/* Where lines break: against closed forms. Folds of known angle, joints of known curvature, kinks by the formula of
 * the surface's second form, borders, faces of a non-manifold edge, darts, semi-sharp creases, vertices. Random cages
 * are judged by tests/oracle/test_breaks.cpp. */
#include <malloc.h>
#include <string.h>

#include "server/curves/breaks/breaks.h"
#include "server/curves/computation.h"
#include "server/surface/evaluate.h"
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

static struct computation *start(const struct limit_tables *tables,
                                 const struct break_limits *limits)
{
    const struct break_lines lines = {&LINES, &LIGHT, 1};
    struct error error = {0};
    struct computation *computation = breaks_create(tables, &lines, limits, &error);
    assert_non_null(computation);
    return computation;
}

static struct computation *find(const struct limit_tables *tables)
{
    struct error error = {0};
    struct computation *computation = start(tables, &LIMITS);
    assert_true(computation_run(computation, &error));
    return computation;
}

/* --- cages */

/* A sheet of 4 x n faces of side 1 that is folded along x = 0 by `angle` radians, with an infinitely sharp crease
 * along the first n_creased edges of the fold. */
static void build_fold(double angle, int n, int n_creased, double sharpness,
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

static int add_patch(char *text, int used, int first, double left, const struct quadratic *q,
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
static void build_joint(const struct quadratic *left, const struct quadratic *right,
                        bool turned_over, struct limit_tables *tables)
{
    static char text[10000];
    int used = add_patch(text, 0, 0, -1, left, false);
    used = add_patch(text, used, 16, 0, right, turned_over);
    used += sprintf(text + used, "t interpolateboundary 1/0/0 0\n");
    build(text, (size_t)used, tables);
}

static const struct break_worst *worst(const struct breaks_found *result, size_t i,
                                       enum break_measure measure)
{
    return &result->edges[i].worst[measure];
}

/* --- creases */

static void a_fold_has_its_angle(void **state)
{
    (void)state;
    const double angles[] = {1e-3, 0.02, 0.5, 1.5, 2.9};
    for (size_t i = 0; i < sizeof angles / sizeof *angles; i++) {
        struct limit_tables tables;
        build_fold(angles[i], 3, 3, 10, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        assert_int_equal(result.n_edges, 3);
        assert_int_equal(result.counts.creases, 3);
        for (size_t k = 0; k < 3; k++) {
            double degrees = angles[i] * 180 / 3.14159265358979323846;
            double relative =
                i == 0 ? 2e-4 : 1e-6; /* single precision of the points: 1e-5 degrees */
            assert_true(fabs(worst(&result, k, BREAK_ANGLE)->value / degrees - 1) < relative);
            assert_true(worst(&result, k, BREAK_GAP)->value < 1e-7);
            assert_true(worst(&result, k, BREAK_PERCENT)->value < 0.2);
            bool is_over = degrees > LIMITS.angle_deg;
            assert_int_equal(result.edges[k].over, is_over << BREAK_ANGLE);
            assert_true(fabs(result.edges[k].out_length - is_over * result.edges[k].length) < 1e-9);
        }
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

/* Without a crease a sheet is smooth, and nothing is measured. */
static void a_smooth_sheet_has_no_edges(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.5, 3, 0, 0, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_edges, 0);
    assert_int_equal(result.counts.borders, 14);
    assert_int_equal(result.n_vertices, 4); /* its corners, where the border is round */
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* At the end of a crease the angle falls to 0; the crease's other edges do not end there. */
static void a_dart_ends_a_crease(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.5, 4, 2, 10, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_edges, 2);
    size_t dart = result.edges[0].has_dart ? 0 : 1, other = 1 - dart;
    assert_true(result.edges[dart].has_dart && !result.edges[other].has_dart);
    assert_true(fabs(worst(&result, other, BREAK_ANGLE)->value - 0.5 * 180 / M_PI) < 1e-4);
    assert_true(fabs(result.edges[other].out_length - result.edges[other].length) < 1e-9);
    /* The worst place is at the end that is no dart: y = 1, where the other edge is. */
    assert_true(fabs(worst(&result, dart, BREAK_ANGLE)->point[1] - 1) < 0.01);
    assert_true(result.edges[dart].out_length < 0.999 * result.edges[dart].length);
    assert_true(result.edges[dart].out_length > 0.9 * result.edges[dart].length);
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* All derivatives up to the second are the same on both sides of an edge. */
static void assert_smooth(const struct limit_tables *tables, const struct break_edge *edge)
{
    for (int k = 1; k < 20; k++) {
        struct limit_point side[2];
        for (int i = 0; i < 2; i++) {
            const struct limit_place place = {edge->face[i], edge->edge[i],
                                              i ? 1 - k / 20.0 : k / 20.0, 0};
            assert_true(limit_evaluate_at(tables, &place, &side[i]));
        }
        /* Across the edge the second face's parameters run against those of the first. */
        const struct vec differences[] = {
            vec_sub(side[0].s, side[1].s), vec_add(side[0].sv, side[1].sv),
            vec_sub(side[0].suv, side[1].suv), vec_sub(side[0].svv, side[1].svv)};
        for (int i = 0; i < 4; i++)
            assert_true(vec_length(differences[i]) < 1e-5 * (1 + vec_length(side[0].svv)));
    }
}

/* The surface along a crease of finite sharpness is smooth. It turns by the fold's angle within a strip that is as
 * narrow as the sharpness is high. */
static void a_semisharp_crease_is_no_break(void **state)
{
    (void)state;
    struct limit_tables tables;
    double last = 0;
    for (int sharpness = 1; sharpness <= 6; sharpness++) {
        build_fold(0.5, 3, 3, sharpness, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        assert_int_equal(result.n_edges, 3);
        assert_int_equal(result.counts.semisharp, 3);
        for (size_t k = 0; k < 3; k++) {
            const struct break_edge *edge = &result.edges[k];
            assert_int_equal(edge->kind, BREAK_SEMISHARP);
            assert_smooth(&tables, edge);
            assert_int_equal(edge->over, 0);
            assert_true(edge->out_length == 0);
            assert_true(isnan(edge->worst[BREAK_GAP].value) &&
                        isnan(edge->worst[BREAK_KINK].value));
            assert_true(edge->worst[BREAK_ANGLE].value > 10);
            assert_true(edge->worst[BREAK_ANGLE].value < 0.5 * 180 / M_PI + 1e-4);
        }
        /* The same turn in half the width: twice the curvature. */
        double bend = worst(&result, 1, BREAK_CURVATURE)->value;
        assert_true(sharpness < 3 || fabs(bend / last - 2) < 0.05);
        last = bend;
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

/* --- joints */

static void a_joint_has_its_curvature_jump(void **state)
{
    (void)state;
    const struct quadratic pairs[][2] = {
        {{0, 0, 0, 0}, {0.2, 0, 0, 0}},
        {{-0.3, 0, 0.1, 0}, {0.2, 0, 0.1, 0}},
        {{1, 0.3, -0.2, 0}, {1.02, 0.3, -0.2, 0}},
        {{0.5, 0, 0, 0}, {0.5, 0, 0, 0}},
    };
    for (size_t i = 0; i < 2 * sizeof pairs / sizeof *pairs; i++) {
        const struct quadratic *left = &pairs[i / 2][0], *right = &pairs[i / 2][1];
        struct limit_tables tables;
        build_joint(left, right, i & 1, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        assert_int_equal(result.n_edges, 1);
        assert_int_equal(result.edges[0].kind, BREAK_JOINT);
        assert_int_equal(result.counts.joints, 1);
        assert_int_equal(result.counts.borders, 8);
        assert_true(worst(&result, 0, BREAK_GAP)->value < 1e-6);
        assert_true(worst(&result, 0, BREAK_ANGLE)->value < 1e-4);
        /* At x = 0: z_x = b y, z_y = c y; the curvature across is that of the section along n x e. */
        double most = 0, most_percent = 0;
        for (int k = 0; k <= 1000; k++) {
            double y = k / 1000.0, zx = left->b * y, zy = left->c * y;
            double e = 1 + zx * zx, f = zx * zy, g = 1 + zy * zy, w = sqrt(e * g - f * f);
            /* x = (dx, dy) with unit length, perpendicular to (0, 1) in the surface's metric */
            double dx = sqrt(g) / w, dy = -f / g * dx, k_of[2];
            for (int side = 0; side < 2; side++) {
                const struct quadratic *q = side ? right : left;
                k_of[side] = (q->a * dx * dx + 2 * q->b * dx * dy + q->c * dy * dy) / w;
            }
            most = fmax(most, fabs(k_of[0] - k_of[1]));
            double sum = fmax(fabs(k_of[0]) + fabs(k_of[1]), 1e-3);
            most_percent = fmax(most_percent, 200 * fabs(k_of[0] - k_of[1]) / sum);
        }
        assert_true(fabs(worst(&result, 0, BREAK_CURVATURE)->value - most) < 1e-3 * most + 1e-5);
        assert_true(fabs(worst(&result, 0, BREAK_PERCENT)->value - most_percent) <
                    1e-3 * most_percent + 0.2);
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

static void a_joint_has_its_gap(void **state)
{
    (void)state;
    const double gaps[] = {2e-5, 9e-5, 3e-4, 2e-3, 4e-3};
    for (size_t i = 0; i < sizeof gaps / sizeof *gaps; i++) {
        const struct quadratic left = {0.1, 0.2, 0.3, 0}, right = {0.1, 0.2, 0.3, gaps[i]};
        struct limit_tables tables;
        build_joint(&left, &right, false, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        if (gaps[i] > 1e-3 * breaks_diagonal(&tables)) { /* too far apart to be one edge */
            assert_int_equal(result.n_edges, 0);
        } else {
            /* The nearest point is not the one above: the surface slopes there by up to 0.3. */
            double gap = worst(&result, 0, BREAK_GAP)->value;
            assert_int_equal(result.n_edges, 1);
            assert_true(gap <= gaps[i] + 1e-7 && gap > 0.9 * gaps[i]);
            assert_int_equal((result.edges[0].over >> BREAK_GAP) & 1, gaps[i] > LIMITS.gap);
        }
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

/* The joints that are found, and how many of them exceed the limit of the gap. */
static void expect_joints(struct limit_tables *tables, double limit, size_t n, size_t n_over)
{
    const struct break_limits limits = {limit, 0.1, 10};
    struct error error = {0};
    struct computation *computation = start(tables, &limits);
    assert_true(computation_run(computation, &error));
    const struct breaks_found result = breaks_result(computation);
    size_t over = 0;
    for (size_t i = 0; i < result.n_edges; i++)
        over += result.edges[i].over >> BREAK_GAP & 1;
    assert_int_equal(result.counts.joints, n);
    assert_int_equal(over, n_over);
    computation_destroy(computation);
}

static void a_stricter_limit_keeps_the_joints(void **state)
{
    (void)state;
    const struct quadratic left = {0}, right = {0, 0, 0, 1e-4};
    struct limit_tables tables;
    build_joint(&left, &right, false, &tables);
    expect_joints(&tables, 1e-8, 1, 1);
    expect_joints(&tables, 5e-5, 1, 1);
    expect_joints(&tables, 2e-4, 1, 0);
    expect_joints(&tables, 1, 1, 0);
    limit_tables_finish(&tables);
}

/* Two sheets of one face, the second one above the first: their four borders lie on the same side. */
static void skins_of_a_part_are_no_joints(void **state)
{
    (void)state;
    const double heights[] = {1e-3, 5e-5};
    for (size_t i = 0; i < 2; i++) {
        const struct quadratic low = {0}, high = {0, 0, 0, heights[i]};
        static char text[10000];
        struct limit_tables tables;
        int used = add_patch(text, 0, 0, 0, &low, false);
        used = add_patch(text, used, 16, 0, &high, false);
        used += sprintf(text + used, "t interpolateboundary 1/0/0 0\n");
        build(text, (size_t)used, &tables);
        expect_joints(&tables, 1e-6, i == 0 ? 0 : 4, i == 0 ? 0 : 4);
        expect_joints(&tables, 0.01, 4, 0);
        limit_tables_finish(&tables);
    }
}

/* A strip whose two borders are nearer than the distance, of one face and of two, for a strict and a loose limit. */
static void a_thin_strip_has_no_joints(void **state)
{
    (void)state;
    const int n_across[] = {1, 2};
    for (size_t i = 0; i < 2; i++) {
        char text[2000];
        int used = 0, n = n_across[i];
        for (int y = 0; y <= 3; y++)
            for (int x = 0; x <= n; x++)
                used += sprintf(text + used, "v %.17g %d 0\n", 1e-4 * x, y);
        for (int y = 0; y < 3; y++)
            for (int x = 0; x < n; x++) {
                int a = (n + 1) * y + x + 1;
                used += sprintf(text + used, "f %d %d %d %d\n", a, a + 1, a + n + 2, a + n + 1);
            }
        struct limit_tables tables;
        build(text, (size_t)used, &tables);
        expect_joints(&tables, 1e-8, 0, 0);
        expect_joints(&tables, 1, 0, 0);
        limit_tables_finish(&tables);
    }
}

/* The faces at an edge of three pages are joined in pairs. */
static void pages_of_a_book(void **state)
{
    (void)state;
    char text[1000];
    const double turns[] = {0, 0.7, 2.5};
    int used = sprintf(text, "v 0 0 0\nv 0 0 1\n");
    for (int k = 0; k < 3; k++)
        used += sprintf(text + used, "v %.17g %.17g 0\nv %.17g %.17g 1\n", cos(turns[k]),
                        sin(turns[k]), cos(turns[k]), sin(turns[k]));
    for (int k = 0; k < 3; k++)
        used += sprintf(text + used, "f 1 %d %d 2\n", 3 + 2 * k, 4 + 2 * k);
    used += sprintf(text + used, "t interpolateboundary 1/0/0 2\n");
    struct limit_tables tables;
    build(text, (size_t)used, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.counts.borders, 12);
    assert_int_equal(result.n_edges, 3);
    unsigned seen = 0;
    for (size_t k = 0; k < 3; k++) {
        const struct break_edge *edge = &result.edges[k];
        assert_int_equal(edge->kind, BREAK_JOINT);
        assert_true(edge->worst[BREAK_GAP].value < 1e-7);
        /* All pages are wound away from the spine: each pair traverses it alike, so one is turned over. */
        double between = fabs(turns[edge->face[0]] - turns[edge->face[1]]);
        double degrees = (M_PI - between) * 180 / M_PI;
        assert_true(fabs(edge->worst[BREAK_ANGLE].value - degrees) < 1e-4);
        seen |= 1u << (edge->face[0] + edge->face[1]);
    }
    assert_int_equal(seen, 1 << 1 | 1 << 2 | 1 << 3);
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* --- lines */

static struct vec vec_of(const double v[3])
{
    return (struct vec){v[0], v[1], v[2]};
}

/* The place on the light in spacings along u, of a ray from p mirrored by n: the textbook's formula. */
static double place_on_light(struct vec p, struct vec n)
{
    struct vec v = vec_unit(vec_sub(p, vec_of(LINES.eye)));
    struct vec r = vec_mad(v, -2 * vec_dot(v, n), n);
    struct vec u = vec_of(LIGHT.u), w = vec_of(LIGHT.v), c = vec_of(LIGHT.centre);
    struct vec y = vec_sub(vec_mad(p, (c.z - p.z) / r.z, r), c);
    double s = (y.x * w.y - y.y * w.x) / (u.x * w.y - u.y * w.x); /* y = s u + t w */
    return s * vec_length(u) / LIGHT.pattern.period;
}

static void on_quadratic(const struct quadratic *q, double x, double y, struct vec *p,
                         struct vec *n)
{
    *p = (struct vec){x, y, q->a * x * x / 2 + q->b * x * y + q->c * y * y / 2 + q->d};
    *n = vec_unit((struct vec){-(q->a * x + q->b * y), -(q->b * x + q->c * y), 1});
}

/* The direction of a line on a quadratic, by differences. */
static struct vec line_on(const struct quadratic *q, double x, double y)
{
    const double h = 1e-4;
    struct vec p[4], n[4];
    const double dx[4] = {h, -h, 0, 0}, dy[4] = {0, 0, h, -h};
    double s[4];
    for (int i = 0; i < 4; i++) {
        on_quadratic(q, x + dx[i], y + dy[i], &p[i], &n[i]);
        s[i] = place_on_light(p[i], n[i]);
    }
    /* Along (-s_y, s_x) in the parameters s does not change. */
    struct vec px = vec_sub(p[0], p[1]), py = vec_sub(p[2], p[3]);
    return vec_unit(vec_mad(vec_scale(px, -(s[2] - s[3])), s[0] - s[1], py));
}

/* The kink by the formula: g+ = g- - dk (ds/dN . x) x, with the gradient g- of one side. */
static double kink_by_formula(const struct quadratic *left, double dk, double y)
{
    struct vec p, n, e = vec_unit((struct vec){0, 1, left->c * y});
    on_quadratic(left, 0, y, &p, &n);
    struct vec x = vec_cross(n, e), g = vec_cross(line_on(left, 0, y), n); /* of unit length */
    const double h = 1e-5;
    /* The size and sign of the gradient along e, and ds/dN along x, by differences. */
    struct vec p2[2], n2[2];
    for (int i = 0; i < 2; i++)
        on_quadratic(left, 0, y + (i ? -h : h), &p2[i], &n2[i]);
    double along = (place_on_light(p2[0], n2[0]) - place_on_light(p2[1], n2[1])) /
                   vec_dot(vec_sub(p2[0], p2[1]), e);
    double by_normal =
        (place_on_light(p, vec_mad(n, h, x)) - place_on_light(p, vec_mad(n, -h, x))) / (2 * h);
    struct vec before = vec_scale(g, along / vec_dot(g, e));
    struct vec after = vec_mad(before, -dk * by_normal, x);
    return atan2(vec_length(vec_cross(before, after)), vec_dot(before, after)) * 180 / M_PI;
}

static void kinks_by_the_formula(void **state)
{
    (void)state;
    const double jumps[] = {1e-3, 1e-2, 0.1, 0.4};
    for (size_t i = 0; i < sizeof jumps / sizeof *jumps; i++) {
        const struct quadratic left = {0.1, 0.05, -0.2, 0}, right = {0.1 + jumps[i], 0.05, -0.2, 0};
        struct limit_tables tables;
        build_joint(&left, &right, false, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        assert_int_equal(result.n_edges, 1);
        const struct break_worst *kink = worst(&result, 0, BREAK_KINK);
        struct vec a = line_on(&left, 0, kink->point[1]), b = line_on(&right, 0, kink->point[1]);
        double by_lines = atan2(vec_length(vec_cross(a, b)), vec_dot(a, b)) * 180 / M_PI;
        assert_true(fabs(kink->value / by_lines - 1) < 1e-3);
        double by_formula = kink_by_formula(&left, jumps[i], kink->point[1]);
        assert_true(fabs(kink->value / by_formula - 1) < 0.01);
        /* It is the worst of the whole edge. */
        for (int k = 1; k < 100; k++) {
            a = line_on(&left, 0, k / 100.0);
            b = line_on(&right, 0, k / 100.0);
            double there = atan2(vec_length(vec_cross(a, b)), vec_dot(a, b)) * 180 / M_PI;
            assert_true(there < kink->value * 1.001);
        }
        assert_true(worst(&result, 0, BREAK_JUMP)->value < 1e-3); /* G1: lines do not step */
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

/* A fold moves lines by the places of its two mirrors. */
static void a_fold_makes_lines_jump(void **state)
{
    (void)state;
    struct limit_tables tables;
    const double angle = 0.01;
    build_fold(angle, 3, 3, 10, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    for (size_t k = 0; k < result.n_edges; k++) {
        const struct break_worst *jump = worst(&result, k, BREAK_JUMP);
        struct vec p = vec_of(jump->point), up = {0, 0, 1}, turned = {-sin(angle), 0, cos(angle)};
        double by_mirrors = fabs(place_on_light(p, up) - place_on_light(p, turned));
        assert_true(fabs(jump->value / by_mirrors - 1) < 1e-4);
        const double h = 1e-4; /* the gradient on the first side, which is flat */
        double gx = (place_on_light(vec_mad(p, h, (struct vec){1, 0, 0}), up) -
                     place_on_light(vec_mad(p, -h, (struct vec){1, 0, 0}), up)) /
                    (2 * h);
        double gy = (place_on_light(vec_mad(p, h, (struct vec){0, 1, 0}), up) -
                     place_on_light(vec_mad(p, -h, (struct vec){0, 1, 0}), up)) /
                    (2 * h);
        double shift = by_mirrors / hypot(gx, gy);
        assert_true(fabs(result.edges[k].shift / shift - 1) < 0.02);
    }
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* --- vertices, and the work as a whole */

static const char CUBE[] =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

static void vertices_of_a_cube(void **state)
{
    (void)state;
    struct limit_tables tables;
    build(CUBE, sizeof CUBE - 1, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_vertices, 8);
    for (size_t i = 0; i < 8; i++) {
        const struct break_vertex *vertex = &result.vertices[i];
        assert_true(vertex->is_inside);
        assert_int_equal(vertex->n_faces, 3);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(fabs(vertex->point[k]) - fabs(vertex->point[0])) < 1e-6);
        /* A convex body seen from outside, and all its corners are alike. */
        assert_true(vertex->k_least <= vertex->k_greatest && vertex->k_greatest < 0);
        assert_true(fabs(vertex->k_least - result.vertices[0].k_least) < 1e-4);
        assert_true(vertex->radius > 0 && vertex->radius < 0.1);
    }
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* Runs the slices of each phase from the last to the first. */
static void run_backwards(struct computation *computation)
{
    struct error error = {0};
    for (unsigned phase = 0; computation->kind->stages[phase]; phase++) {
        size_t n = 0;
        assert_true(computation->kind->begin(computation, phase, &n, &error));
        while (n > 0)
            computation->kind->slice(computation, --n);
    }
}

static void the_order_of_slices_changes_nothing(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.3, 20, 20, 10, &tables);
    struct computation *forwards = find(&tables), *backwards = start(&tables, &LIMITS);
    run_backwards(backwards);
    const struct breaks_found a = breaks_result(forwards), b = breaks_result(backwards);
    assert_int_equal(a.n_edges, 20);
    assert_int_equal(b.n_edges, 20);
    for (size_t i = 0; i < 20; i++) {
        uint8_t bytes[2][BREAK_EDGE_BYTES];
        break_edge_pack(&a.edges[i], bytes[0]);
        break_edge_pack(&b.edges[i], bytes[1]);
        assert_memory_equal(bytes[0], bytes[1], BREAK_EDGE_BYTES);
    }
    assert_memory_equal(&a.counts, &b.counts, sizeof a.counts);
    computation_destroy(forwards);
    computation_destroy(backwards);
    limit_tables_finish(&tables);
}

static size_t heap_bytes(void)
{
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

/* A computation takes at most the memory that it says, so that its client can be charged before it begins. (Sanitizers
 * have another heap, of which the C library knows nothing.) */
static void memory_is_bounded(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct error error = {0};
    build_fold(0.3, 60, 60, 10, &tables);
    const size_t before = heap_bytes();
    size_t most = 0;
    struct computation *computation = start(&tables, &LIMITS);
    for (unsigned phase = 0; computation->kind->stages[phase]; phase++) {
        size_t n = 0;
        assert_true(computation->kind->begin(computation, phase, &n, &error));
        most = heap_bytes() - before > most ? heap_bytes() - before : most;
        for (size_t i = 0; i < n; i++)
            computation->kind->slice(computation, i);
    }
    assert_int_equal(breaks_result(computation).n_edges, 60);
    assert_true(most + 60 * BREAK_EDGE_BYTES <= breaks_bytes(&tables));
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

static void a_cancelled_computation_ends(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct error error = {0};
    build_fold(0.3, 3, 3, 10, &tables);
    struct computation *computation = start(&tables, &LIMITS);
    atomic_store(&computation->cancelled, true);
    assert_false(computation_run(computation, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    computation_destroy(computation);
    computation_destroy(NULL);
    limit_tables_finish(&tables);
}

/* The worst edge comes first, and those over a limit before all others. */
static void edges_are_sorted(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.4, 6, 4, 10, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_edges, 4);
    assert_int_equal(result.counts.edges_out, 4);
    double length = 0;
    for (size_t i = 0; i < 4; i++) {
        length += result.edges[i].length;
        assert_true(i == 0 || worst(&result, i, BREAK_ANGLE)->value <=
                                  worst(&result, i - 1, BREAK_ANGLE)->value + 1e-9);
    }
    assert_true(fabs(length - result.counts.creases_length) < 1e-9);
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fold_has_its_angle),
        cmocka_unit_test(a_smooth_sheet_has_no_edges),
        cmocka_unit_test(a_dart_ends_a_crease),
        cmocka_unit_test(a_semisharp_crease_is_no_break),
        cmocka_unit_test(a_joint_has_its_curvature_jump),
        cmocka_unit_test(a_joint_has_its_gap),
        cmocka_unit_test(a_stricter_limit_keeps_the_joints),
        cmocka_unit_test(skins_of_a_part_are_no_joints),
        cmocka_unit_test(a_thin_strip_has_no_joints),
        cmocka_unit_test(pages_of_a_book),
        cmocka_unit_test(kinks_by_the_formula),
        cmocka_unit_test(a_fold_makes_lines_jump),
        cmocka_unit_test(vertices_of_a_cube),
        cmocka_unit_test(the_order_of_slices_changes_nothing),
        cmocka_unit_test(memory_is_bounded),
        cmocka_unit_test(a_cancelled_computation_ends),
        cmocka_unit_test(edges_are_sorted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
