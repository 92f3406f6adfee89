/* The grids that stage 1 draws. No triangle deviates further from the surface than allowed, no grid
 * is finer than its part of the surface needs in either direction, and clusters of nodes omit
 * nothing. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/render/patch_grids.h"
#include "server/scene/defaults.h"
#include "server/surface/evaluate.h"
#include "tests/unit/cage_tables.h"

enum { WIDTH = 960, HEIGHT = 540 };

static const struct tile WHOLE = {0, 0, WIDTH, HEIGHT};

struct scene {
    struct limit_tables tables;
    struct clusters clusters;
    struct view view;
    struct patch_grids grids;
};

/* Completes the scene; the caller has built the tables. */
static void scene_ready(struct scene *scene)
{
    struct error error = {0};
    if (!clusters_init(&scene->clusters, &scene->tables, &error))
        fail_msg("%s", error.text);
}

static void scene_finish(struct scene *scene)
{
    patch_grids_finish(&scene->grids);
    clusters_finish(&scene->clusters);
    limit_tables_finish(&scene->tables);
}

/* The default camera, with its distance from the box's middle divided by `closer`. */
static void look(struct scene *scene, bool orthographic, double closer)
{
    struct camera camera;
    const struct limit_tables *t = &scene->tables;
    scene_default_camera(t, NULL, VIEW_AROUND, WIDTH, HEIGHT, &camera);
    for (int i = 0; i < 3; i++) {
        double away = (camera.eye[i] - camera.target[i]) / closer;
        camera.target[i] = 0.5 * (t->box_min[i] + t->box_max[i]);
        camera.eye[i] = camera.target[i] + away;
    }
    if (orthographic) {
        camera.kind = CAMERA_ORTHOGRAPHIC;
        camera.ortho_height =
            1.2 * (t->box_max[2] - t->box_min[2] + t->box_max[0] - t->box_min[0]) / closer;
    }
    view_init(&scene->view, &camera, WIDTH, HEIGHT, t->hull_min, t->hull_max);
}

static void choose(const struct scene *scene, const struct clusters *clusters,
                   const struct tile *tile, struct patch_grids *grids)
{
    struct error error = {0};
    if (!patch_grids_choose(grids, &scene->tables, clusters, &scene->view, tile, &error))
        fail_msg("%s", error.text);
}

/* --- */

static struct limit_point surface_at(const struct scene *scene, const struct patch_grid *grid,
                                     double x, double y)
{
    const struct limit_node *node = &scene->tables.nodes[grid->node];
    unsigned square = grid->where >> 6 & 3;
    int level = grid->where & 63;
    double size = ldexp(1, -(int)(grid->where >> 8 & 0xff));
    double s = (square == 1 || square == 2) + (grid->x + x) * size;
    double t = (square >= 2) + (grid->y + y) * size;
    const struct limit_place place = {grid->node, node->rotation,
                                      ldexp(s, node->kind == LIMIT_STRIP ? 0 : -level),
                                      ldexp(t, -level)};
    struct limit_point point;
    assert_true(limit_evaluate_at(&scene->tables, &place, &point));
    return point;
}

/* The visible length in px of a vector that starts at the surface point `p`. The part of it along
 * the surface counts a quarter. */
static double shown_px(const struct view *view, const struct limit_point *p, struct vec off)
{
    const double world[3] = {p->s.x, p->s.y, p->s.z};
    double camera[3];
    view_transform(view, world, camera);
    double across = p->has_normal ? fabs(vec_dot(off, p->n)) : 0;
    double along = sqrt(fmax(vec_dot(off, off) - across * across, 0));
    double depth = view->perspective ? fmax(camera[2], view->near) : 1;
    return (across + along / 4) / (view->units_per_px * depth);
}

/* The distance of the surface from a cell's triangles, measured at the middles of their sides and
 * at their centres. */
static double stray_px(const struct scene *scene, const struct patch_grid *grid, double x, double y,
                       double width, double height)
{
    static const double weights[4][3] = {
        {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {1 / 3.0, 1 / 3.0, 1 / 3.0}};
    double most = 0;
    for (int half = 0; half < 2; half++) {
        const double at[3][2] = {
            {x + half * width, y + half * height}, {x + width, y}, {x, y + height}};
        struct vec corner[3];
        for (int k = 0; k < 3; k++)
            corner[k] = surface_at(scene, grid, at[k][0], at[k][1]).s;
        for (int w = 0; w < 4; w++) {
            double place[2] = {0, 0};
            struct vec flat = {0, 0, 0};
            for (int k = 0; k < 3; k++) {
                place[0] += weights[w][k] * at[k][0];
                place[1] += weights[w][k] * at[k][1];
                flat = vec_mad(flat, weights[w][k], corner[k]);
            }
            struct limit_point p = surface_at(scene, grid, place[0], place[1]);
            most = fmax(most, shown_px(&scene->view, &p, vec_sub(flat, p.s)));
        }
    }
    return most;
}

/* Every seventh cell of all grids. */
static double largest_stray_px(const struct scene *scene)
{
    const struct patch_grids *grids = &scene->grids;
    double most = 0;
    for (int g = 0; g < GRID_SHAPES; g++) {
        unsigned m = grid_cells[g / GRID_SIDES], n = grid_cells[g % GRID_SIDES];
        for (size_t i = grids->first[g]; i < grids->first[g + 1]; i++) {
            assert_int_equal(grids->grid[i].where >> 16, g);
            for (unsigned k = (unsigned)i % 7; k < m * n; k += 7)
                most = fmax(most, stray_px(scene, &grids->grid[i], k % m / (double)m,
                                           k / m / (double)n, 1.0 / m, 1.0 / n));
        }
    }
    return most;
}

static void test_no_triangle_strays(void **state)
{
    (void)state;
    static const char *const paths[] = {"tests/models/fender.obj", "tests/models/creases.obj",
                                        "tests/models/ngons.obj", "tests/models/body.obj",
                                        "tests/models/pole.obj"};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        struct scene scene = {0};
        build_file(paths[i], &scene.tables);
        scene_ready(&scene);
        for (int view = 0; view < 4; view++) {
            look(&scene, view & 1, view & 2 ? 20 : 1);
            choose(&scene, &scene.clusters, &WHOLE, &scene.grids);
            double most = largest_stray_px(&scene);
            if (!(most <= 0.5 && most >= 0.1))
                fail_msg("%s, view %d: %.3f px", paths[i], view, most);
        }
        scene_finish(&scene);
    }
}

/* --- */

/* A tube of 8 x 8 quads, bent along u only. */
static void test_one_way(void **state)
{
    (void)state;
    static char text[1 << 14];
    size_t used = 0;
    for (unsigned k = 0; k < 8 * 9; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "v %.17g %.17g %u\n",
                                 cos(k % 8 * 0.7853981633974483), sin(k % 8 * 0.7853981633974483),
                                 k / 8);
    for (unsigned k = 0; k < 8 * 8; k++) {
        unsigned row = k / 8 * 8 + 1, next = (k + 1) % 8;
        used += (size_t)snprintf(text + used, sizeof text - used, "f %u %u %u %u\n", row + k % 8,
                                 row + next, row + 8 + next, row + 8 + k % 8);
    }
    struct scene scene = {0};
    build(text, used, &scene.tables);
    scene_ready(&scene);
    look(&scene, true, 1);
    choose(&scene, &scene.clusters, &WHOLE, &scene.grids);
    assert_int_equal(scene.grids.first[GRID_SHAPES], 64);
    for (int g = 0; g < GRID_SHAPES; g++) {
        if (scene.grids.first[g] == scene.grids.first[g + 1])
            continue;
        assert_int_equal(grid_cells[g % GRID_SIDES], 1);
        assert_in_range(grid_cells[g / GRID_SIDES], 3, 4);
    }
    scene_finish(&scene);
}

/* --- */

/* The number of clusters that the tile cannot show. */
static size_t n_outside(const struct scene *scene, const struct tile *tile)
{
    struct view_sides sides;
    size_t n = 0;
    view_sides_init(&sides, &scene->view, tile);
    for (size_t k = 0; k < scene->clusters.n; k++) {
        double centre[3];
        view_transform(&scene->view, scene->clusters.cluster[k].centre, centre);
        n += view_sides_exclude(&sides, centre, scene->clusters.cluster[k].radius);
    }
    return n;
}

static void assert_same_grids(const struct patch_grids *a, const struct patch_grids *b)
{
    assert_memory_equal(a->first, b->first, sizeof a->first);
    assert_memory_equal(a->grid, b->grid, a->first[GRID_SHAPES] * sizeof *a->grid);
    assert_int_equal(a->n_blocks, b->n_blocks);
    assert_memory_equal(a->block, b->block, a->n_blocks * sizeof *a->block);
}

/* In every tile, the clusters that it cannot show are skipped and no others: the grids are the same
 * as those of clusters with boundless boxes. */
static void test_clusters_leave_out_nothing(void **state)
{
    (void)state;
    static const char *const paths[] = {"tests/models/fender.obj", "tests/models/creases.obj",
                                        "tests/models/nonmanifold.obj", NULL};
    enum { N = 5 };
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        struct scene scene = {0};
        struct clusters all = {0};
        struct patch_grids expected = {0};
        struct error error = {0};
        size_t n_passed_over = 0;
        if (paths[i])
            build_file(paths[i], &scene.tables);
        else
            build_torus(40, &scene.tables);
        scene_ready(&scene);
        assert_true(clusters_init(&all, &scene.tables, &error));
        for (size_t k = 0; k < all.n; k++)
            all.cluster[k].radius = INFINITY;
        for (int view = 0; view < 4; view++) {
            look(&scene, view & 1, view & 2 ? 8 : 1);
            for (uint32_t k = 0; k < N * N; k++) {
                const struct tile tile = {k % N * WIDTH / N, k / N * HEIGHT / N, WIDTH / N,
                                          HEIGHT / N};
                choose(&scene, &scene.clusters, &tile, &scene.grids);
                choose(&scene, &all, &tile, &expected);
                assert_same_grids(&scene.grids, &expected);
                n_passed_over += n_outside(&scene, &tile);
            }
        }
        assert_true(n_passed_over > N * N); /* of 4 N N for each cluster */
        patch_grids_finish(&expected);
        clusters_finish(&all);
        scene_finish(&scene);
    }
}

/* Many sheets behind each other. A ray gets a guess for each sheet, or for none if there are too
 * many to try. */
static void test_guesses_are_limited(void **state)
{
    (void)state;
    static const size_t n_sheets[2] = {MAX_GUESSES / 64, 2 * MAX_GUESSES};
    for (size_t i = 0; i < 2; i++) {
        size_t size = n_sheets[i] * 160, used = 0;
        char *text = malloc(size);
        assert_non_null(text);
        for (size_t k = 0; k < n_sheets[i]; k++) {
            double z = 1e-4 * (double)k;
            used += (size_t)snprintf(text + used, size - used,
                                     "v -1 -1 %g\nv 1 -1 %g\nv 1 1 %g\nv -1 1 %g\nf -4 -3 -2 -1\n",
                                     z, z, z, z);
        }
        struct scene scene = {0};
        struct error error = {0};
        const struct tile middle = {WIDTH / 2, HEIGHT / 2, 1, 1};
        build(text, used, &scene.tables);
        scene_ready(&scene);
        look(&scene, true, 1);
        assert_true(patch_grids_guess(&scene.grids, &scene.tables, &scene.clusters, &scene.view,
                                      &middle, &error));
        if (i == 0)
            assert_in_range(scene.grids.n_guesses, n_sheets[i], MAX_GUESSES);
        else
            assert_int_equal(scene.grids.n_guesses, 0);
        scene_finish(&scene);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_triangle_strays),
        cmocka_unit_test(test_one_way),
        cmocka_unit_test(test_clusters_leave_out_nothing),
        cmocka_unit_test(test_guesses_are_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
