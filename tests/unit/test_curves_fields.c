/* F of lines on patches: its derivatives, its ranges over pieces, and its crossings along segments,
 * each against F at points. */
#include <math.h>
#include <string.h>

#include "tests/unit/cage_tables.h"
#include "tests/unit/random_lines.h"

#include "server/curves/fields/crossings.h"
#include "server/surface/evaluate.h"

/* The change of F by finite differences. */
static void jets_have_the_derivatives(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/body.obj", &tables);
    random_state = 9;
    for (unsigned kind = 0; kind < 140; kind++) {
        struct line_map map;
        struct line_field field;
        struct field_line line;
        random_map(kind, 2, &map);
        if (!line_field_init(&field, &map) || !field_line_init(&field, 0.4, &line))
            continue;
        struct limit_patch patch;
        struct bezier bezier;
        struct limit_place place = {.node = kind % (uint32_t)tables.n_faces, .a = 0.3, .b = 0.6};
        assert_true(limit_patch_find(&tables, &place, &patch));
        bezier_of_patch(&bezier, &tables, &patch);
        double jet[5][3], h = 1e-4;
        const double at[5][2] = {
            {0.4, 0.7}, {0.4 + h, 0.7}, {0.4 - h, 0.7}, {0.4, 0.7 + h}, {0.4, 0.7 - h}};
        for (int k = 0; k < 5; k++) {
            struct bezier_jet surface;
            bezier_jet_at(&bezier, at[k][0], at[k][1], &surface);
            field_jet(&field, &line, bezier.origin, &surface, jet[k]);
        }
        double size = fmax(fmax(fabs(jet[0][0]), fabs(jet[0][1])), fabs(jet[0][2]));
        assert_true(fabs((jet[1][0] - jet[2][0]) / (2 * h) - jet[0][1]) < 1e-5 * size);
        assert_true(fabs((jet[3][0] - jet[4][0]) / (2 * h) - jet[0][2]) < 1e-5 * size);
    }
    limit_tables_finish(&tables);
}

/* A bumpy patch; of odd kinds small and gentle. */
static void random_patch(unsigned kind, struct limit_tables *tables, struct bezier *bezier)
{
    struct vec points[4][4];
    struct limit_patch patch;
    for (int k = 0; k < 16; k++) {
        double z = random_signed(), size = kind % 2 ? 0.02 : 1;
        points[k / 4][k % 4] =
            (struct vec){size * (k % 4 / 3.0 + 0.1 * random_signed()),
                         size * (k / 4 / 3.0 + 0.1 * random_signed()), size * 0.1 * z};
    }
    build_bezier(points, tables);
    limit_patch_of_level(&patch, tables, &tables->nodes[BEZIER_FACE], 0, 0.5, 0.5);
    bezier_of_patch(bezier, tables, &patch);
}

static bool random_line(unsigned kind, struct line_field *field, struct field_line *line)
{
    struct line_map map;
    double place = 0.1 + 0.8 * random_number();
    random_map(kind, 1, &map);
    return line_field_init(field, &map) && field_line_init(field, place, line);
}

/* F at (u,v) with its derivatives, for the normal divided by its part along c, as ranges have
 * it. */
static void jet_along(const struct line_field *field, const struct field_line *line,
                      const struct bezier *bezier, struct vec c, double u, double v, double jet[3])
{
    struct bezier_jet at;
    bezier_jet_at(bezier, u, v, &at);
    struct vec n = at.n[0];
    double part = vec_dot(n, c);
    at.n[0] = vec_scale(n, 1 / part);
    for (int k = 1; k < 3; k++)
        at.n[k] = vec_scale(vec_mad(at.n[k], -vec_dot(at.n[k], c) / part, n), 1 / part);
    field_jet(field, line, bezier->origin, &at, jet);
}

/* The Taylor polynomial and its derivatives by x and y. */
static void polynomial_at(const double range[RANGE_SIZE], double x, double y, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i <= RANGE_ORDER; i++) {
        for (int j = 0; i + j <= RANGE_ORDER; j++) {
            double c = range[range_at(i, j)];
            out[0] += c * pow(x, i) * pow(y, j);
            out[1] += i ? c * i * pow(x, i - 1) * pow(y, j) : 0;
            out[2] += j ? c * j * pow(x, i) * pow(y, j - 1) : 0;
        }
    }
}

struct counted {
    unsigned checked, signs, slopes;
    double tightest; /* the largest share of a rest that is used */
};

/* F and its derivatives at points of a piece differ from the polynomial by no more than the rests,
 * and have the signs that the range claims. */
static void check_piece(const struct line_field *field, const struct field_line *line,
                        const struct bezier *bezier, const struct piece *piece,
                        struct counted *counted)
{
    struct piece_range surface;
    struct field_range terms;
    double range[RANGE_SIZE];
    piece_find_range(piece, &surface);
    field_find_range(field, bezier->origin, &surface, &terms);
    field_line_range(&terms, line, range);
    if (!isfinite(range[RANGE_REST]))
        return;
    struct vec c = {surface.n[0][0], surface.n[1][0], surface.n[2][0]};
    int sign = range_sign(range),
        slope[2] = {range_slope_sign(range, 0, 0), range_slope_sign(range, 1, 0)};
    int quick = field_quick_sign(&terms, line);
    bool never = field_is_never_met(&terms, line);
    assert_true(quick == 0 || quick == sign);
    counted->checked++;
    counted->signs += sign != 0;
    counted->slopes += slope[0] != 0;
    for (int i = 0; i < 25; i++) {
        double x = i < 4 ? (i & 1 ? 1 : -1) : random_signed();
        double y = i < 4 ? (i & 2 ? 1 : -1) : random_signed(), jet[3], expected[3];
        double u = piece->at[0] + 0.5 * piece->size * (1 + x);
        double v = piece->at[1] + 0.5 * piece->size * (1 + y);
        jet_along(field, line, bezier, c, u, v, jet);
        polynomial_at(range, x, y, expected);
        double rounding =
            1e-10 * (range[RANGE_SUM] + range[RANGE_OFF] + fabs(terms.g[0][0]) +
                     fabs(line->w[1] * terms.g[1][0]) + fabs(line->w[2] * terms.g[2][0]));
        for (int k = 0; k < 3; k++) {
            double is = k ? 0.5 * piece->size * jet[k] : jet[k];
            double off = fabs(is - expected[k]), rest = range[RANGE_REST + k];
            assert_true(off <= rest + rounding);
            if (rest > 10 * rounding)
                counted->tightest = fmax(counted->tightest, off / rest);
            assert_true(k == 0 || slope[k - 1] == 0 || slope[k - 1] * is > -rounding);
        }
        assert_true(sign == 0 || sign * jet[0] > -rounding);
        if (never) {
            struct limit_point at = {0};
            struct bezier_jet surface_at;
            bezier_jet_at(bezier, u, v, &surface_at);
            at.s = vec_add(bezier->origin, surface_at.s[0]);
            at.n = vec_unit(surface_at.n[0]);
            /* Where the line is not met, no place on the light is the line's. */
            double residual = field_residual(field, line, at.s, at.n);
            assert_false(fabs(residual) < 1e-9);
        }
    }
}

static void ranges_contain_all_values(void **state)
{
    (void)state;
    struct counted counted = {0};
    random_state = 7;
    for (unsigned kind = 0; kind < 280; kind++) {
        struct limit_tables tables;
        struct bezier bezier;
        struct line_field field;
        struct field_line line;
        random_patch(kind, &tables, &bezier);
        if (random_line(kind, &field, &line)) {
            struct piece piece, quarters[4];
            piece_of_bezier(&bezier, &piece);
            for (unsigned depth = 0; depth < 6; depth++) {
                check_piece(&field, &line, &bezier, &piece, &counted);
                piece_quarter(&piece, quarters);
                piece = quarters[(kind + depth) % 4];
            }
        }
        limit_tables_finish(&tables);
    }
    print_message("%u ranges, %u with a sign, %u with a slope; %.2f of a rest is used\n",
                  counted.checked, counted.signs, counted.slopes, counted.tightest);
    assert_true(counted.checked > 800 && counted.signs > 200 && counted.slopes > 200);
    assert_true(counted.tightest > 0.1);
}

/* Sides and spokes against the signs at many places. */
static void all_crossings_are_found_and_no_others(void **state)
{
    (void)state;
    unsigned found = 0, several = 0;
    random_state = 13;
    for (unsigned kind = 0; kind < 280; kind++) {
        struct limit_tables tables;
        struct bezier bezier;
        struct line_field field;
        struct field_line line;
        random_patch(2 * kind, &tables, &bezier);
        bool is_known = random_line(kind, &field, &line);
        for (int side = 0; is_known && side < 4; side++) {
            enum { STEPS = 2000 };
            struct patch_field on;
            struct segment segment;
            struct crossings crossings;
            double at[MOST_CROSSINGS], least = 1;
            unsigned n = 0;
            segment_of_bezier(&bezier, side, &segment);
            if (kind % 3 == 0)
                segment_reverse(&segment);
            patch_field_init(&on, &field, &bezier);
            crossings_init(&crossings, &on, &segment);
            bool negative[2] = {patch_field_is_negative(&on, &line, segment.from),
                                patch_field_is_negative(&on, &line, segment.to)};
            size_t n_parts = 0;
            unsigned is = (unsigned)crossings_find(&crossings, &on, &line, negative, at, &n_parts);
            for (unsigned k = 1; k < is; k++)
                least = fmin(least, at[k] - at[k - 1]);
            assert_true(least > 0);
            bool before = negative[0];
            for (int i = 1; i <= STEPS; i++) {
                double t = (double)i / STEPS, x[2];
                for (int k = 0; k < 2; k++)
                    x[k] = segment.from[k] + t * (segment.to[k] - segment.from[k]);
                bool now = patch_field_is_negative(&on, &line, x);
                if (now != before && n < is)
                    assert_true(least < 2. / STEPS || fabs(at[n] - t) < 1.01 / STEPS);
                n += now != before;
                before = now;
            }
            assert_true(n == is || (n < is && least < 1. / STEPS));
            found += is;
            several += is > 1;
        }
        limit_tables_finish(&tables);
    }
    print_message("%u crossings, %u sides with several\n", found, several);
    assert_true(found > 300 && several > 30);
}

/* The eye lies in the plane of the patch, so that F is 0 but for rounding, and the noise is set to
 * 0: F changes its sign at random. */
static void more_crossings_than_fit_keep_the_parity(void **state)
{
    (void)state;
    enum { CANARY = 200 };
    unsigned most = 0, sides[2] = {0, 0};
    random_state = 29;
    for (int i = 0; i < 60; i++) {
        struct vec a = {random_signed(), random_signed(), random_signed()};
        struct vec b = {random_signed(), random_signed(), random_signed()};
        struct bezier bezier = {.origin = {0, 0, 0}};
        struct line_map map = {.eye_is_point = true, .eye = vec_mad(vec_scale(a, 3), -2, b)};
        struct line_field field;
        struct field_line line;
        struct patch_field on;
        struct segment segment;
        struct crossings crossings;
        double at[MOST_CROSSINGS + CANARY];
        for (int k = 0; k < 16; k++) {
            struct vec p = vec_mad(vec_scale(a, k / 4 + 0.2 * random_signed()),
                                   k % 4 + 0.2 * random_signed(), b);
            bezier.p[0][k / 4][k % 4] = p.x;
            bezier.p[1][k / 4][k % 4] = p.y;
            bezier.p[2][k / 4][k % 4] = p.z;
        }
        silhouette_field_init(&field, &map);
        assert_true(field_line_init(&field, 0, &line));
        patch_field_init(&on, &field, &bezier);
        on.bounds.g[0] = 0;
        segment_of_bezier(&bezier, i % 4, &segment);
        crossings_init(&crossings, &on, &segment);
        for (int k = 0; k < MOST_CROSSINGS + CANARY; k++)
            at[k] = -1;
        bool negative[2] = {patch_field_is_negative(&on, &line, segment.from),
                            patch_field_is_negative(&on, &line, segment.to)};
        size_t n_parts = 0;
        unsigned n = (unsigned)crossings_find(&crossings, &on, &line, negative, at, &n_parts);
        assert_true(n <= MOST_CROSSINGS && n % 2 == (negative[0] != negative[1]));
        for (unsigned k = 1; k < n; k++)
            assert_true(at[k] > at[k - 1]);
        for (int k = MOST_CROSSINGS; k < MOST_CROSSINGS + CANARY; k++)
            assert_true(at[k] == -1);
        most = n > most ? n : most;
        sides[n % 2]++;
    }
    print_message("%u crossings at most\n", most);
    assert_true(most >= MOST_CROSSINGS - 1 && sides[0] > 5 && sides[1] > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jets_have_the_derivatives),
        cmocka_unit_test(ranges_contain_all_values),
        cmocka_unit_test(all_crossings_are_found_and_no_others),
        cmocka_unit_test(more_crossings_than_fit_keep_the_parity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
