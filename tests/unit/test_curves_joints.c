/* Where lines break, against closed forms: joints of known curvature and gap, borders that are no joint, faces of a
 * non-manifold edge; kinks by the formula of the surface's second form, and jumps of lines by mirrors. */
#include "tests/unit/break_cages.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_joint_has_its_curvature_jump),
        cmocka_unit_test(a_joint_has_its_gap),
        cmocka_unit_test(a_stricter_limit_keeps_the_joints),
        cmocka_unit_test(skins_of_a_part_are_no_joints),
        cmocka_unit_test(a_thin_strip_has_no_joints),
        cmocka_unit_test(pages_of_a_book),
        cmocka_unit_test(kinks_by_the_formula),
        cmocka_unit_test(a_fold_makes_lines_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
