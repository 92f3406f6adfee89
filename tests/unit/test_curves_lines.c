/* Lines as curves: against closed forms, against a grid that counts them, and against a second evaluation of every
 * point. */
#include <math.h>
#include <string.h>

#include "tests/unit/cage_tables.h"
#include "tests/unit/random_lines.h"
#include "tests/unit/surface_curves.h"

#include "server/surface/evaluate.h"

static const char *const MODELS = "tests/models/";

static void build_model(const char *name, struct limit_tables *tables)
{
    char path[100];
    snprintf(path, sizeof path, "%s%s.obj", MODELS, name);
    build_file(path, tables);
}

/* On a plane mirror the lines of a plane light are straight, whatever the eye. */
static void lines_on_a_plane_mirror_are_straight(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_model("plane", &tables);
    double size = tables.box_max[0] - tables.box_min[0];
    const struct lines lines = {.eye_kind = LINE_EYE_POINT, .eye = {0.3 * size, -1.1 * size, size}};
    const struct light light = {.kind = LIGHT_PLANE,
                                .centre = {0.2, 0.1, 2 * size},
                                .u = {size, 0.3 * size, 0.1 * size},
                                .v = {0, size, 0.2}};
    struct line_map map;
    struct line_set *set = calloc(1, sizeof *set);
    line_map_init(&map, &lines, &light);
    for (int i = 0; i < 21; i++)
        line_set_add(set, &map, 0, -1 + 0.15 * i);
    struct surface_lines *traced = trace_set(&tables, set, 1e-3 * size);
    struct surface_lines_result result = surface_lines_get(traced);
    assert_true(result.curves->n_curves >= 10);
    assert_int_equal(result.n_marks, 0);
    for (size_t c = 0; c < result.curves->n_curves; c++) {
        const struct curve *curve = &result.curves->curve[c];
        const struct traced_point *p = result.curves->point + curve->first;
        struct vec along = vec_unit(vec_sub(p[curve->n - 1].p, p[0].p));
        assert_false(curve->closed);
        for (size_t k = 0; k < curve->n; k++) {
            struct vec off = vec_cross(along, vec_sub(p[k].p, p[0].p));
            assert_true(vec_length(off) < 1e-9 * size);
        }
    }
    computation_destroy(surface_lines_computation(traced));
    limit_tables_finish(&tables);
    free(set);
}

/* A parabolic cylinder z = -x^2/2, which one patch is exactly, seen straight from above: a place on a plane light depends on x
 * alone. The ray at x has slope 2 x / (1 - x^2) against the vertical. */
static long double parabola_place(long double x, long double height)
{
    long double z = -x * x / 2, across = 2 * x, up = 1 - x * x;
    return x + across / up * (height - z);
}

static void lines_on_a_parabolic_cylinder_are_where_they_belong(void **state)
{
    (void)state;
    struct vec bezier[4][4];
    struct limit_tables tables;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            /* x from -1/2 to 1/2; -x^2/2 in Bernstein form, raised from degree 2. */
            static const double z[4] = {-0.125, 0.125 / 3, 0.125 / 3, -0.125};
            bezier[j][i] = (struct vec){i / 3.0 - 0.5, j / 3.0, z[i]};
        }
    }
    build_bezier(bezier, &tables);
    const struct lines lines = {.eye_kind = LINE_EYE_DIRECTION, .eye = {0, 0, -1}};
    const struct light light = {
        .kind = LIGHT_PLANE, .centre = {0, 0, 3}, .u = {2, 0, 0}, .v = {0, 2, 0}};
    struct line_map map;
    struct line_set *set = calloc(1, sizeof *set);
    line_map_init(&map, &lines, &light);
    for (int i = 0; i < 9; i++)
        line_set_add(set, &map, 0, 0.13 + 0.1 * i);
    struct surface_lines *traced = trace_set(&tables, set, 1e-3);
    struct surface_lines_result result = surface_lines_get(traced);
    assert_int_equal(result.curves->n_curves, 9);
    for (size_t c = 0; c < 9; c++) {
        const struct curve *curve = &result.curves->curve[c];
        long double low = -0.5L, high = 0.5L;
        long double wanted = 2 * ((long double)set->line[curve->line].place - 0.5L);
        for (int i = 0; i < 100; i++) {
            long double middle = (low + high) / 2;
            *(parabola_place(middle, 3) < wanted ? &low : &high) = middle;
        }
        for (size_t k = 0; k < curve->n; k++) {
            /* The stored points are single: x and z are within 1e-7 of the parabola. */
            double x = result.curves->point[curve->first + k].p.x;
            assert_true(fabsl((long double)x - low) < 3e-7L);
        }
    }
    computation_destroy(surface_lines_computation(traced));
    limit_tables_finish(&tables);
    free(set);
}

/* The place on the light over a patch, as on a grid of GRID x GRID cells. It is evaluated at every STEP-th node, and at all nodes of
 * those blocks of STEP x STEP cells where a line may be, because the place changes by less between the block's corners than
 * the corners differ from the line. */
enum { GRID = 2000, STEP = 8, BLOCKS = GRID / STEP, ROW = GRID + 1 };

struct place_grid {
    double place[ROW * ROW];
    bool is_fine[BLOCKS * BLOCKS];
};

static void place_node(const struct limit_tables *tables, const struct line_map *map, int i, int j,
                       struct place_grid *grid)
{
    struct limit_point at;
    double *place = &grid->place[j * ROW + i];
    if (isnan(*place)) {
        limit_evaluate(tables, BEZIER_FACE, (double)i / GRID, (double)j / GRID, &at);
        *place = line_position_at(map, at.s, at.n).s;
    }
}

/* Twice the largest difference of neighbouring corners, of the block and of those around it. */
static double change_about(const struct place_grid *grid, int x, int y)
{
    double most = 0;
    for (int j = y > 0 ? y - 1 : y; j <= y + 1 && j < BLOCKS; j++) {
        for (int i = x > 0 ? x - 1 : x; i <= x + 1 && i < BLOCKS; i++) {
            const double *at = &grid->place[j * STEP * ROW + i * STEP];
            const double corner[4] = {at[0], at[STEP], at[STEP * ROW + STEP], at[STEP * ROW]};
            for (int k = 0; k < 4; k++) {
                double d = corner[(k + 1) & 3] - corner[k];
                most = fmax(most, fabs(d - round(d)));
            }
        }
    }
    return 2 * most;
}

static void fill_grid(const struct limit_tables *tables, const struct line_map *map,
                      const struct line_set *set, struct place_grid *grid)
{
    for (int k = 0; k < ROW * ROW; k++)
        grid->place[k] = NAN;
    for (int j = 0; j <= GRID; j += STEP)
        for (int i = 0; i <= GRID; i += STEP)
            place_node(tables, map, i, j, grid);
    for (int b = 0; b < BLOCKS * BLOCKS; b++) {
        int x = b % BLOCKS, y = b / BLOCKS;
        double change = change_about(grid, x, y);
        grid->is_fine[b] = false;
        for (uint32_t line = 0; line < set->n_lines; line++) {
            double d = grid->place[y * STEP * ROW + x * STEP] - set->line[line].place;
            grid->is_fine[b] |= fabs(d - round(d)) <= change;
        }
    }
    for (int b = 0; b < BLOCKS * BLOCKS; b++)
        for (int k = 0; grid->is_fine[b] && k < (STEP + 1) * (STEP + 1); k++)
            place_node(tables, map, b % BLOCKS * STEP + k % (STEP + 1),
                       b / BLOCKS * STEP + k / (STEP + 1), grid);
}

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* Places of closed lights are compared the shorter way around. Places that are not known are far from all lines. */
static bool crosses(double a, double b, double wanted)
{
    a -= wanted + round(a - wanted);
    b -= wanted + round(b - wanted);
    return (a > 0) != (b > 0) && fabs(a - b) < 0.5;
}

/* The cells of a grid that a line crosses, and which of them are connected. */
struct crossed_cells {
    uint32_t parent[GRID * GRID];
    bool crossed[GRID * GRID];
};

/* Joins a cell with the one before it along x or y, if the line crosses their common edge. */
static void join_cells(const struct place_grid *grid, double wanted, struct crossed_cells *cells,
                       int i, int j)
{
    const double *at = grid->place + j * ROW + i;
    uint32_t self = (uint32_t)(j * GRID + i);
    if (!cells->crossed[self])
        return;
    if (i > 0 && cells->crossed[self - 1] && crosses(at[0], at[ROW], wanted))
        cells->parent[root_of(cells->parent, self)] = root_of(cells->parent, self - 1);
    if (j > 0 && cells->crossed[self - GRID] && crosses(at[0], at[1], wanted))
        cells->parent[root_of(cells->parent, self)] = root_of(cells->parent, self - GRID);
}

/* The number of connected components of a line: cells with different signs at their corners, joined across shared edges whose
 * ends differ. */
static unsigned count_on_grid(const struct place_grid *grid, double wanted)
{
    static struct crossed_cells cells;
    unsigned n = 0;
    memset(cells.crossed, 0, sizeof cells.crossed);
    for (int pass = 0; pass < 3; pass++) {
        for (int k = 0; k < GRID * GRID; k++) {
            int b = k / (STEP * STEP), i = b % BLOCKS * STEP + k % STEP;
            int j = b / BLOCKS * STEP + k / STEP % STEP;
            const double *at = grid->place + j * ROW + i;
            uint32_t self = (uint32_t)(j * GRID + i);
            if (!grid->is_fine[b]) {
                k += STEP * STEP - 1;
            } else if (pass == 0) {
                cells.parent[self] = self;
                cells.crossed[self] =
                    crosses(at[0], at[1], wanted) || crosses(at[ROW], at[ROW + 1], wanted) ||
                    crosses(at[0], at[ROW], wanted) || crosses(at[1], at[ROW + 1], wanted);
            } else if (pass == 1) {
                join_cells(grid, wanted, &cells, i, j);
            } else {
                n += cells.crossed[self] && cells.parent[self] == self;
            }
        }
    }
    return n;
}

/* Wavy patches, on which lines close: as many curves as on the grid. */
static void the_grid_shows_as_many_curves(void **state)
{
    (void)state;
    static struct place_grid grid;
    unsigned curves = 0, closed = 0;
    random_state = 3;
    for (int round = 0; round < 6; round++) {
        struct vec bezier[4][4];
        struct limit_tables tables;
        for (int k = 0; k < 16; k++)
            bezier[k / 4][k % 4] = (struct vec){k % 4 / 3.0, k / 4 / 3.0, 0.15 * random_signed()};
        for (int k = 0; k < 4; k++) /* a dome, so that isophotes close */
            bezier[1 + k / 2][1 + k % 2].z += 0.3;
        build_bezier(bezier, &tables);
        struct lines lines = {.family = round % 3 == 0 ? LINES_ISOPHOTE : LINES_REFLECTION,
                              .eye_kind = LINE_EYE_POINT,
                              .has_direction = true,
                              .direction = {0.1, 0.2, 1},
                              .eye = {0.4, -0.3, 40}};
        struct light light = {.kind = round % 3 == 1 ? LIGHT_TUNNEL : LIGHT_SPHERE,
                              .u = {round % 3 == 1 ? 50 : 0, 0, round % 3 == 1 ? 0 : 1},
                              .v = {0.1, 1, 0}};
        struct line_map map;
        struct line_set *set = calloc(1, sizeof *set);
        line_map_init(&map, &lines, &light);
        for (int i = 0; i < 12; i++) {
            double at = lines.family == LINES_ISOPHOTE ? 0.03 + 0.02 * i : 0.29 + 0.033 * i;
            assert_int_equal(line_set_add(set, &map, 0, at), LINE_ADDED);
        }
        fill_grid(&tables, &map, set, &grid);
        struct surface_lines *traced = trace_set(&tables, set, 1e-3);
        struct surface_lines_result result = surface_lines_get(traced);
        assert_int_equal(result.n_marks, 0);
        for (uint32_t i = 0; i < set->n_lines; i++) {
            unsigned n = 0;
            for (size_t c = 0; c < result.curves->n_curves; c++) {
                n += result.curves->curve[c].line == i;
                closed += result.curves->curve[c].line == i && result.curves->curve[c].closed;
            }
            assert_int_equal(n, count_on_grid(&grid, set->line[i].place));
            curves += n;
        }
        computation_destroy(surface_lines_computation(traced));
        limit_tables_finish(&tables);
        free(set);
    }
    print_message("%u curves, %u closed\n", curves, closed);
    assert_true(curves > 50 && closed > 1);
}

/* Whether a curve's end is where lines may end: at a border of the surface; at a mark; or where the ray ceases to meet the
 * light, or the place on it jumps, as at the pole of an azimuth. */
static bool may_end(const struct limit_tables *tables, const struct line_field *field,
                    const struct field_line *line, const struct surface_lines_result *result,
                    const struct traced_point *end, double tolerance)
{
    for (size_t k = 0; k < result->n_marks; k++)
        if (vec_length(vec_sub(result->marks[k].at.p, end->p)) < 3 * tolerance)
            return true;
    const double out[4] = {end->v, 1 - end->u, 1 - end->v, end->u};
    for (unsigned e = 0; e < 4; e++)
        if (out[e] < 1e-9 &&
            (tables->nodes[end->face].borders >> (4 * e) & 15) == LIMIT_BORDER_SHARP)
            return true;
    for (int k = 0; k < 32; k++) { /* the light ends nearby */
        double angle = k * 0.2, step = 1e-5;
        struct limit_point at;
        double u = fmin(fmax(end->u + step * cos(angle), 0), 1);
        double v = fmin(fmax(end->v + step * sin(angle), 0), 1);
        if (!limit_evaluate(tables, end->face, u, v, &at))
            continue;
        if (!(fabs(field_residual(field, line, at.s, at.n)) < 0.05))
            return true;
    }
    return false;
}

/* Around extraordinary vertices lines are joined within the tolerance. The vertex may lie within a face, where it is split. */
static bool is_at_vertex(const struct limit_tables *tables, const struct traced_point *point,
                         double distance)
{
    static const int end_a[4] = {0, 1, 1, 0}, end_b[4] = {0, 0, 1, 1};
    const struct limit_node *node = &tables->nodes[point->face];
    struct limit_point at;
    while (node->kind == LIMIT_SPLIT) {
        double x = ldexp(point->u, node->depth) - (node->cell & 0xffff);
        double y = ldexp(point->v, node->depth) - (node->cell >> 16);
        node = &tables->nodes[node->first + (y < 0.5 ? x >= 0.5 : x < 0.5 ? 3 : 2)];
    }
    double u = ldexp((double)(node->cell & 0xffff) + end_a[node->rotation & 3], -node->depth);
    double v = ldexp((double)(node->cell >> 16) + end_b[node->rotation & 3], -node->depth);
    return node->kind == LIMIT_CORNER && limit_evaluate(tables, point->face, u, v, &at) &&
           vec_length(vec_sub(at.s, point->p)) < distance;
}

/* By how much the rounding of doubles moves the place of a point on its line: the rounding of F, divided by F's change
 * for a change of the place. It is large where the ray runs nearly along the light, because there F hardly depends on the place. */
static double rounding_of_place(const struct line_field *field, const struct field_line *line,
                                const struct limit_point *at, struct vec n)
{
    const double step = 1e-6;
    struct field_bounds bounds;
    struct bezier_jet jet = {.n = {n}};
    struct field_line beside;
    double f[2], out[3];
    field_find_bounds(field, at->s, 0, &bounds);
    for (int k = 0; k < 2; k++) {
        if (!field_line_init(field, line->place + (k ? step : -step), &beside))
            return 0;
        field_jet(field, &beside, at->s, &jet, out);
        f[k] = out[0];
    }
    return 0x1p-52 * field_bound(&bounds, line) * 2 * step / fabs(f[1] - f[0]);
}

/* Whether a point may lie where two patches of a face meet: there the other patch may be evaluated, which single precision stores
 * otherwise: rounding is that of single precision. */
static bool is_on_seam(const struct traced_point *point)
{
    double u = ldexp(point->u, 12), v = ldexp(point->v, 12);
    return u == floor(u) || v == floor(v);
}

/* Every point again by line_position(), on every family and light, and every end. Lines end nowhere else. */
static void check_model(const char *name, unsigned first_kind, unsigned kinds)
{
    struct limit_tables tables;
    size_t points = 0, seams = 0, near_vertices = 0, loose = 0, wrong = 0;
    double most = 0; /* off, as a part of what is allowed */
    build_model(name, &tables);
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, tables.box_max[k] - tables.box_min[k]);
    for (unsigned kind = first_kind; kind < first_kind + kinds; kind++) {
        struct line_map map;
        struct line_set *set = calloc(1, sizeof *set);
        const int n_lines = 8;
        random_map(kind, size, &map);
        for (int i = 0; i < n_lines; i++)
            line_set_add(set, &map, 0, (i + 0.37) / n_lines);
        double tolerance = 1e-4 * size;
        struct surface_lines *traced = trace_set(&tables, set, tolerance);
        struct surface_lines_result result = surface_lines_get(traced);
        for (size_t c = 0; c < result.curves->n_curves; c++) {
            const struct curve *curve = &result.curves->curve[c];
            const struct traced_point *p = result.curves->point + curve->first;
            const struct line_field *field = line_set_field(set, curve->line);
            for (size_t k = 0; k < curve->n; k++) {
                struct limit_point at;
                points++;
                assert_true(limit_evaluate(&tables, p[k].face, p[k].u, p[k].v, &at));
                double off = vec_length(vec_sub(at.s, p[k].p)) / size;
                assert_true(off < 1e-6);
                bool is_end = !curve->closed && (k == 0 || k + 1 == curve->n);
                /* Not at.n, which is turned by a rounded quaternion after it was computed. */
                struct vec n = vec_unit(vec_cross(at.su, at.sv));
                const struct field_line *line = &set->line[curve->line];
                double residual = fabs(field_residual(field, line, at.s, n));
                double rounding = 16 * rounding_of_place(field, line, &at, n);
                double allowed = fmax(1e-9 / n_lines, rounding);
                /* Where the light begins or ends to be met, rounding decides whether it is. */
                bool is_unmet =
                    is_end && (isnan(residual) || line_position_at(&map, at.s, n).sine < 1.01e-6);
                if (residual < allowed)
                    most = fmax(most, residual / allowed);
                else if (is_at_vertex(&tables, &p[k], 4 * tolerance))
                    near_vertices++;
                else if (is_on_seam(&p[k]) && residual < fmax(2e-5 / n_lines, 0x1p26 * rounding))
                    seams++;
                else
                    loose += !is_unmet;
                wrong += is_end && !may_end(&tables, field, &set->line[curve->line], &result, &p[k],
                                            tolerance);
            }
        }
        computation_destroy(surface_lines_computation(traced));
        free(set);
    }
    print_message("%s: %zu points, %zu on seams, %zu at vertices, %zu loose (%.2f of what is "
                  "allowed), %zu wrong ends\n",
                  name, points, seams, near_vertices, loose, most, wrong);
    assert_int_equal(wrong, 0);
    assert_int_equal(loose, 0);
    assert_true(points > 1000);
    limit_tables_finish(&tables);
}

static void every_point_is_on_its_line(void **state)
{
    (void)state;
    random_state = 11;
    check_model("body", 0, 40);
    check_model("sheet", 3, 20);
    check_model("fender", 0, 6);
}

static void creases_and_ngons_are_joined(void **state)
{
    (void)state;
    random_state = 5;
    check_model("creases", 0, 10);
    check_model("ngons", 0, 10);
    check_model("chaikin", 5, 5);
    check_model("nonmanifold", 0, 10);
    check_model("pole", 0, 5);
}

/* A light so far away that numbers overflow: each line on each patch is undecided, and none is dropped. */
static void what_overflows_is_marked(void **state)
{
    (void)state;
    struct limit_tables tables;
    const struct lines lines = {.eye_kind = LINE_EYE_POINT, .eye = {0, 0, 1e160}};
    struct light light = {
        .kind = LIGHT_TUNNEL, .centre = {1e160, 0, 0}, .u = {1e160, 0, 0}, .v = {0, 1e160, 0}};
    light.pattern.rotation_deg = 90;
    struct line_map map;
    struct line_set *set = calloc(1, sizeof *set);
    build_model("plane", &tables);
    line_map_init(&map, &lines, &light);
    for (int i = 0; i < 3; i++)
        assert_int_equal(line_set_add(set, &map, 0, 0.2 + 0.3 * i), LINE_ADDED);
    struct surface_lines *traced = trace_set(&tables, set, 1e-3);
    struct surface_lines_result result = surface_lines_get(traced);
    size_t n_patches = 0;
    for (size_t k = 0; k < tables.n_faces; k++)
        n_patches += tables.nodes[k].kind == LIMIT_REGULAR;
    assert_true(n_patches > 0);
    assert_true(result.n_marks >= 3 * n_patches);
    computation_destroy(surface_lines_computation(traced));
    limit_tables_finish(&tables);
    free(set);
}

/* Slices in the opposite order give the same bytes. */
static void order_of_slices_has_no_effect(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct line_map map;
    struct line_set *set = calloc(1, sizeof *set);
    struct error error = {0};
    build_model("body", &tables);
    random_state = 2;
    random_map(10, 2, &map);
    for (int i = 0; i < 6; i++)
        line_set_add(set, &map, 0, 0.1 + 0.13 * i);
    struct surface_lines *forwards = trace_set(&tables, set, 1e-3);
    struct surface_lines *backwards =
        surface_lines_create(&tables, set, 1e-3, (size_t)1 << 30, &error);
    struct computation *run = surface_lines_computation(backwards);
    for (unsigned phase = 0; run->kind->stages[phase]; phase++) {
        size_t n = 0;
        assert_true(run->kind->begin(run, phase, &n, &error));
        while (n > 0)
            run->kind->slice(run, --n);
    }
    const struct curve_set *a = surface_lines_get(forwards).curves;
    const struct curve_set *b = surface_lines_get(backwards).curves;
    assert_true(a->n_points > 100);
    assert_int_equal(a->n_points, b->n_points);
    assert_int_equal(a->n_curves, b->n_curves);
    for (size_t k = 0; k < a->n_points; k++)
        assert_true(a->point[k].p.x == b->point[k].p.x && a->point[k].u == b->point[k].u);
    computation_destroy(surface_lines_computation(forwards));
    computation_destroy(run);
    limit_tables_finish(&tables);
    free(set);
}

static void memory_is_bounded(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct line_map map;
    struct line_set *set = calloc(1, sizeof *set);
    struct error error = {0};
    build_model("body", &tables);
    random_state = 2;
    random_map(10, 2, &map);
    for (int i = 0; i < 6; i++)
        line_set_add(set, &map, 0, 0.1 + 0.13 * i);
    struct surface_lines *lines = surface_lines_create(&tables, set, 1e-4, 100000, &error);
    assert_non_null(lines);
    assert_false(computation_run(surface_lines_computation(lines), &error));
    assert_int_equal(error.kind, ERROR_REQUEST);
    computation_destroy(surface_lines_computation(lines));
    limit_tables_finish(&tables);
    free(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_on_a_plane_mirror_are_straight),
        cmocka_unit_test(lines_on_a_parabolic_cylinder_are_where_they_belong),
        cmocka_unit_test(the_grid_shows_as_many_curves),
        cmocka_unit_test(every_point_is_on_its_line),
        cmocka_unit_test(creases_and_ngons_are_joined),
        cmocka_unit_test(what_overflows_is_marked),
        cmocka_unit_test(order_of_slices_has_no_effect),
        cmocka_unit_test(memory_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
