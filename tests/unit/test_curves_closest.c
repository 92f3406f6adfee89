/* Counterparts of random points against a search through fine triangles of every face: no triangle may show a hit that
 * is nearer, and what is found must lie on the surface and on the line. */
#include "server/curves/compare/closest.h"
#include "tests/unit/cage_tables.h"

enum { GRID = 16, POINTS = 120 };

static double uniform(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

struct scene {
    struct limit_tables tables;
    struct kept_surface surface;
    struct surface_tree tree;
    double size;
    struct vec *grid; /* [n_faces][GRID + 1][GRID + 1] */
};

/* The tables are built. */
static void open_scene(struct scene *scene)
{
    struct error error = {0};
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += pow(scene->tables.box_max[k] - scene->tables.box_min[k], 2);
    scene->size = sqrt(sum);
    assert_true(kept_surface_init(&scene->surface, &scene->tables, SIZE_MAX, &error));
    for (size_t i = 0; i < scene->surface.n_leaves; i++)
        kept_surface_fill(&scene->surface, i);
    assert_true(surface_tree_init(&scene->tree, &scene->surface, &error));
    for (size_t i = 0; i < scene->surface.n_leaves; i++)
        surface_tree_divide(&scene->tree, i);
    assert_true(surface_tree_allocate(&scene->tree, SIZE_MAX, &error));
    for (size_t i = 0; i < scene->surface.n_leaves; i++)
        surface_tree_fill(&scene->tree, i);
    size_t n = surface_tree_split(&scene->tree);
    for (size_t i = 0; i < n; i++)
        surface_tree_sort(&scene->tree, i);
    surface_tree_join(&scene->tree);
    scene->grid = calloc(scene->tables.n_faces * (GRID + 1) * (GRID + 1), sizeof *scene->grid);
    assert_non_null(scene->grid);
    for (size_t k = 0; k < scene->tables.n_faces * (GRID + 1) * (GRID + 1); k++) {
        struct limit_point at = {.s = {NAN, NAN, NAN}}; /* a hole */
        limit_evaluate(&scene->tables, (uint32_t)(k / ((GRID + 1) * (GRID + 1))),
                       (double)(k % (GRID + 1)) / GRID,
                       (double)(k / (GRID + 1) % (GRID + 1)) / GRID, &at);
        scene->grid[k] = at.s;
    }
}

static void close_scene(struct scene *scene)
{
    free(scene->grid);
    surface_tree_finish(&scene->tree);
    kept_surface_finish(&scene->surface);
    limit_tables_finish(&scene->tables);
}

/* Where the line p + t n meets the plane of a triangle, if it does so within the triangle. */
static bool meet_triangle(struct vec p, struct vec n, struct vec a, struct vec b, struct vec c,
                          double *t)
{
    struct vec u = vec_sub(b, a), v = vec_sub(c, a), to = vec_sub(p, a), h = vec_cross(n, v);
    double det = vec_dot(u, h);
    double x = vec_dot(to, h) / det, y = vec_dot(n, vec_cross(to, u)) / det;
    *t = vec_dot(v, vec_cross(to, u)) / det;
    return x >= 0 && y >= 0 && x + y <= 1;
}

/* Newton's method on a face from (u,v): the place on the line. False if it leaves the face. */
static bool settle(const struct scene *scene, uint32_t face, double u, double v, struct vec p,
                   struct vec n, struct limit_point *at, double *t)
{
    for (int step = 0; step < 20; step++) {
        if (u < 0 || u > 1 || v < 0 || v > 1 || !limit_evaluate(&scene->tables, face, u, v, at))
            return false;
        struct vec d = vec_sub(p, at->s), cross = vec_cross(at->su, at->sv);
        double det = vec_dot(cross, n);
        *t = -vec_dot(cross, d) / det;
        struct vec way = vec_mad(d, *t, n); /* from the place to the line, along the tangents */
        u += vec_dot(n, vec_cross(way, at->sv)) / det;
        v += vec_dot(n, vec_cross(at->su, way)) / det;
        if (vec_length(way) < 1e-12 * scene->size)
            return true;
    }
    return false;
}

/* The least |t| at which the line meets the surface with a normal on its side, by triangles; INFINITY: none. */
static double meet_all(const struct scene *scene, struct vec p, struct vec n, double reach)
{
    double nearest = INFINITY;
    for (uint32_t k = 0; k < scene->tables.n_faces * 2 * GRID * GRID; k++) {
        uint32_t face = k / (2 * GRID * GRID), cell = k / 2 % (GRID * GRID), i = cell % GRID,
                 j = cell / GRID;
        const struct vec *at =
            scene->grid + (size_t)face * (GRID + 1) * (GRID + 1) + j * (GRID + 1) + i;
        double t;
        bool is_first = k % 2 == 0;
        if (!(is_first ? meet_triangle(p, n, at[0], at[1], at[GRID + 2], &t)
                       : meet_triangle(p, n, at[0], at[GRID + 2], at[GRID + 1], &t)))
            continue;
        struct limit_point point;
        if (fabs(t) < 2 * reach &&
            settle(scene, face, (i + 0.5) / GRID, (j + 0.5) / GRID, p, n, &point, &t) &&
            fabs(t) <= reach && vec_dot(point.n, n) > 0)
            nearest = fmin(nearest, fabs(t));
    }
    return nearest;
}

static double nearest_of_grid(const struct scene *scene, struct vec p)
{
    double nearest = INFINITY;
    for (size_t k = 0; k < scene->tables.n_faces * (GRID + 1) * (GRID + 1); k++)
        nearest = fmin(nearest, vec_length(vec_sub(scene->grid[k], p)));
    return nearest;
}

/* The place that was found is on the surface: by its face, u and v. */
static void assert_on_surface(const struct scene *scene, const struct closest *found)
{
    uint32_t face;
    double uv[2];
    struct limit_point at;
    kept_surface_place(&scene->surface, found->leaf, found->x, found->y, &face, uv);
    assert_true(limit_evaluate(&scene->tables, face, fmin(fmax(uv[0], 0), 1),
                               fmin(fmax(uv[1], 0), 1), &at));
    double off = vec_length(vec_sub(at.s, found->at.s));
    if (!(off < 2e-7 * scene->size))
        fail_msg("%g from the surface, leaf %zu %.9f %.9f", off, found->leaf, found->x, found->y);
}

/* Places are in the first n_faces faces, as near to the face's first vertex as 2^-nearest_log2 of its sides. */
static void judge_point(const struct scene *scene, uint32_t n_faces, double nearest_log2,
                        uint32_t *seed, size_t *n_met, size_t *n_near)
{
    struct limit_point at;
    uint32_t face = (uint32_t)(uniform(seed) * n_faces);
    double scale = exp2(-nearest_log2 * uniform(seed));
    if (!limit_evaluate(&scene->tables, face, scale * uniform(seed), scale * uniform(seed), &at) ||
        !at.has_normal)
        return;
    struct vec tilt = {uniform(seed) - 0.5, uniform(seed) - 0.5, uniform(seed) - 0.5};
    struct vec n = vec_unit(vec_mad(at.n, 0.3, tilt));
    double way = 0.05 * scene->size * (uniform(seed) - 0.5), known = fabs(way);
    struct vec p = vec_mad(at.s, way, n);
    if (uniform(seed) < 0.3) {
        p = vec_mad(p, 0.3 * scene->size, tilt); /* the line probably misses */
        known = INFINITY;
    }
    const struct closest_rules rules = {1, 0.05 * scene->size, 0, 0};
    const struct closest_start start = {uniform(seed) < 0.5 ? SIZE_MAX : 0, 0.5, 0.5};
    struct closest found, near;
    closest_find(&scene->tree, &rules, p, n, &start, &found);
    double nearest = fmin(meet_all(scene, p, n, rules.reach), known);
    if (found.kind == CLOSEST_RAY) {
        ++*n_met;
        assert_on_surface(scene, &found);
        struct vec on_line = vec_mad(p, found.distance, n);
        assert_true(vec_length(vec_sub(on_line, found.at.s)) < 1e-9 * scene->size);
        assert_true(fabs(found.distance) <= nearest + 1e-9 * scene->size);
    } else {
        ++*n_near;
        if (nearest < INFINITY)
            fail_msg("a hit at %g of the size was missed", nearest / scene->size);
    }
    closest_nearest(&scene->tree, p, &near);
    assert_on_surface(scene, &near);
    assert_true(fabs(vec_length(vec_sub(near.at.s, p)) - near.distance) < 1e-12 * scene->size);
    assert_true(near.distance <= nearest_of_grid(scene, p) + 1e-9 * scene->size);
}

static void test_random_points(void **state)
{
    (void)state;
    static const char *const models[] = {"tests/models/body.obj", "tests/models/creases.obj",
                                         "tests/models/ngons.obj", "tests/models/pole.obj",
                                         "tests/models/tetra.obj"};
    size_t n_met = 0, n_near = 0;
    for (size_t k = 0; k < sizeof models / sizeof *models; k++) {
        struct scene scene;
        uint32_t seed = 7 + (uint32_t)k;
        build_file_on_demand(models[k], &scene.tables);
        open_scene(&scene);
        for (int i = 0; i < POINTS; i++)
            judge_point(&scene, (uint32_t)scene.tables.n_faces, 0, &seed, &n_met, &n_near);
        close_scene(&scene);
    }
    print_message("%zu met, %zu near\n", n_met, n_near);
    assert_true(n_met > 300 && n_near > 60);
}

/* Many faces meet at a vertex of a bent sheet, in whose sectors faces are hidden from each other's searches. Some places are so near
 * that the levels there are not kept. */
static void test_pole(void **state)
{
    (void)state;
    enum { N = 90, TEXT = 64 * 4 * N };
    char *text = malloc(TEXT), *end = text;
    assert_non_null(text);
    end += sprintf(end, "v 0 0 0.1\n");
    for (int k = 0; k < 2 * N; k++) {
        double a = M_PI * k / N, r = k % 2 ? 1.3 : 1, x = r * cos(a), y = 0.6 * r * sin(a);
        end += sprintf(end, "v %.9g %.9g %.9g\n", x, y, 0.4 * x * y + 0.3 * y);
    }
    for (int k = 0; k < N; k++)
        end += sprintf(end, "f 1 %d %d %d\n", 2 + 2 * k, 3 + 2 * k, 2 + (2 * k + 2) % (2 * N));
    struct scene scene;
    build(text, (size_t)(end - text), &scene.tables);
    free(text);
    open_scene(&scene);
    size_t n_met = 0, n_near = 0;
    uint32_t seed = 3;
    for (int i = 0; i < 3 * POINTS; i++)
        judge_point(&scene, N, i % 2 ? 30 : 0, &seed, &n_met, &n_near);
    print_message("%zu met, %zu near\n", n_met, n_near);
    assert_true(n_met > 200 && n_near > 20);
    close_scene(&scene);
}

/* A point beside a sharp edge, from which the line misses the shrunken face: of both faces at the edge, the one whose
 * normal agrees is taken. */
static void test_crease(void **state)
{
    (void)state;
    static const char cube[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
        "t crease 2/1/0 0 1 10\nt crease 2/1/0 1 2 10\nt crease 2/1/0 2 3 10\n"
        "t crease 2/1/0 3 0 10\nt crease 2/1/0 4 5 10\nt crease 2/1/0 5 6 10\n"
        "t crease 2/1/0 6 7 10\nt crease 2/1/0 7 4 10\nt crease 2/1/0 0 4 10\n"
        "t crease 2/1/0 1 5 10\nt crease 2/1/0 2 6 10\nt crease 2/1/0 3 7 10\n";
    struct scene scene;
    build(cube, sizeof cube - 1, &scene.tables);
    open_scene(&scene);
    const struct closest_rules rules = {1, 0.1, 1e-3, 1e-4};
    const struct closest_start nowhere = {.leaf = SIZE_MAX};
    const struct vec normals[2] = {{0, 0, 1}, {1, 0, 0}};
    for (int k = 0; k < 2; k++) {
        struct closest found;
        closest_find(&scene.tree, &rules, (struct vec){1 + 1e-5, 0.3, 1 + 1e-5}, normals[k],
                     &nowhere, &found);
        assert_int_equal(found.kind, CLOSEST_NEAR);
        assert_true(fabs(found.distance + sqrt(2) * 1e-5) < 1e-8);
        assert_true(vec_dot(found.at.n, normals[k]) > 0.999);
    }
    /* The inner side of the opposite wall is no counterpart. */
    struct closest found;
    const struct closest_rules far = {1, 2, 1e-3, 1e-4};
    closest_find(&scene.tree, &far, (struct vec){0.4, 0.3, 1.01}, normals[0], &nowhere, &found);
    assert_int_equal(found.kind, CLOSEST_RAY);
    assert_true(fabs(found.distance + 0.01) < 1e-7);
    closest_find(&scene.tree, &far, (struct vec){0.4, 0.3, 0.01}, normals[0], &nowhere, &found);
    assert_true(fabs(found.distance - 0.99) < 1e-7);
    close_scene(&scene);
}

static unsigned beats;

static void count_beat(void)
{
    beats++;
}

/* From the middle of a body most of the surface is about equally far, so a single search takes long: it tells that it is
 * alive, and ends when it is cancelled. */
static void test_long_search(void **state)
{
    (void)state;
    struct scene scene;
    struct closest found;
    struct computation computation = {.beat = count_beat};
    build_file("tests/models/body.obj", &scene.tables);
    open_scene(&scene);
    const double *low = scene.tables.box_min, *high = scene.tables.box_max;
    const struct vec middle = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]),
                               0.5 * (low[2] + high[2])};
    scene.tree.computation = &computation;
    beats = 0;
    closest_nearest(&scene.tree, middle, &found);
    assert_int_equal(found.kind, CLOSEST_NEAR);
    unsigned n = beats;
    assert_true(n > 10);
    atomic_store(&computation.cancelled, true);
    beats = 0;
    closest_nearest(&scene.tree, middle, &found);
    assert_int_equal(beats, 1);
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_points),
        cmocka_unit_test(test_pole),
        cmocka_unit_test(test_crease),
        cmocka_unit_test(test_long_search),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
