/* Tables on demand against stored ones: the same nodes, and the same bytes of points and bounds,
 * whatever was requested before, by any number of threads. */
#include <pthread.h>
#include <string.h>

#include "server/surface/evaluate.h"
#include "server/surface/source.h"
#include "tests/unit/cage_tables.h"

static const char *const MODELS[] = {
    "tests/models/body.obj",   "tests/models/chaikin.obj", "tests/models/creases.obj",
    "tests/models/fender.obj", "tests/models/ngons.obj",   "tests/models/nonmanifold.obj",
    "tests/models/pole.obj",   "tests/models/tetra.obj",
};
enum { N_MODELS = sizeof MODELS / sizeof *MODELS, N_THREADS = 3 };

static uint32_t random_below(uint32_t *seed, uint32_t n)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)*seed * n >> 32);
}

static unsigned parts_of(const struct limit_node *node)
{
    return node->kind == LIMIT_CORNER  ? limit_levels(node)
           : node->kind == LIMIT_STRIP ? node->levels + 1u
                                       : 1;
}

/* Where stored tables hold part n of a node: returns its texels and writes its scale. */
static const float (*stored_part(const struct limit_tables *tables, const struct limit_node *node,
                                 unsigned n, float *scale))[4]
{
    const float(*texels)[4] = (const float(*)[4])tables->texels + node->first;
    if (node->kind == LIMIT_CORNER) {
        *scale = texels[1 + (n - 1) / 4][(n - 1) % 4];
        return texels + LIMIT_CORNER_HEAD(limit_levels(node)) + LIMIT_LEVEL_TEXELS * (n - 1);
    }
    texels += LIMIT_PATCH_TEXELS * (n - 1);
    *scale = texels[0][0];
    return texels + 1;
}

static bool is_same(const struct limit_tables *stored, const struct limit_tables *made,
                    uint32_t node, unsigned n)
{
    struct limit_level level;
    float scale;
    const struct limit_node *of = &stored->nodes[node];
    const float(*texels)[4] = stored_part(stored, of, n, &scale);
    size_t bytes =
        sizeof *texels * (of->kind == LIMIT_CORNER ? LIMIT_LEVEL_TEXELS : LIMIT_PATCH_TEXELS - 1);
    made->source->make(made->source, made, node, n, &level, NULL);
    bool is_whole = of->kind == LIMIT_REGULAR;
    struct limit_bound a = is_whole ? stored->whole[node] : limit_level_bound(stored, node, n),
                       b = is_whole ? made->whole[node] : limit_level_bound(made, node, n);
    return scale == level.texels[0][0] && memcmp(texels, level.texels + 1, bytes) == 0 &&
           memcmp(&a, &b, sizeof a) == 0;
}

struct asking {
    const struct limit_tables *stored, *made;
    uint32_t seed, n_asked, n_different;
};

/* Reads parts in random order; often several parts of one node in succession. */
static void *ask(void *argument)
{
    struct asking *asking = argument;
    uint32_t node = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        if (random_below(&asking->seed, 3) == 0)
            node = random_below(&asking->seed, (uint32_t)asking->stored->n_nodes);
        const struct limit_node *of = &asking->stored->nodes[node];
        if (!limit_has_points(of))
            continue;
        unsigned n = 1 + random_below(&asking->seed, parts_of(of));
        asking->n_asked++;
        asking->n_different += !is_same(asking->stored, asking->made, node, n);
    }
    return NULL;
}

static void build_both(const char *path, struct limit_tables *stored, struct limit_tables *made)
{
    build_file(path, stored);
    build_file_on_demand(path, made);
    assert_null(made->texels);
}

static void finish_both(struct limit_tables *stored, struct limit_tables *made)
{
    limit_tables_finish(stored);
    limit_tables_finish(made);
}

static void test_same_points(void **state)
{
    (void)state;
    for (int m = 0; m < N_MODELS; m++) {
        struct limit_tables stored, made;
        build_both(MODELS[m], &stored, &made);
        assert_int_equal(stored.n_nodes, made.n_nodes);
        assert_memory_equal(stored.nodes, made.nodes, stored.n_nodes * sizeof *stored.nodes);
        assert_memory_equal(stored.adjacency, made.adjacency,
                            stored.n_faces * sizeof *stored.adjacency);
        for (uint32_t i = 0; i < stored.n_nodes; i++)
            for (unsigned n = 1;
                 limit_has_points(&stored.nodes[i]) && n <= parts_of(&stored.nodes[i]); n++)
                if (!is_same(&stored, &made, i, n))
                    fail_msg("%s: part %u of node %u differs", MODELS[m], n, i);
        struct asking asking[N_THREADS];
        pthread_t thread[N_THREADS];
        for (uint32_t k = 0; k < N_THREADS; k++) {
            asking[k] = (struct asking){&stored, &made, k, 0, 0};
            assert_int_equal(pthread_create(&thread[k], NULL, ask, &asking[k]), 0);
        }
        for (int k = 0; k < N_THREADS; k++) {
            pthread_join(thread[k], NULL);
            assert_true(asking[k].n_asked > 1000);
            assert_int_equal(asking[k].n_different, 0);
        }
        finish_both(&stored, &made);
    }
}

static bool is_near(const double world[3], struct vec p, double distance)
{
    return fabs(world[0] - p.x) < distance && fabs(world[1] - p.y) < distance &&
           fabs(world[2] - p.z) < distance;
}

/* The corners in a node's head are those of the surface, and the bound of the whole node contains
 * it. */
static void test_heads(void **state)
{
    (void)state;
    for (int m = 0; m < N_MODELS; m++) {
        struct limit_tables made;
        build_file_on_demand(MODELS[m], &made);
        double size = 0;
        for (int k = 0; k < 3; k++)
            size = fmax(size, made.box_max[k] - made.box_min[k]);
        for (uint32_t i = 0; i < made.n_nodes; i++) {
            const struct limit_node *node = &made.nodes[i];
            assert_int_equal(made.whole[i].radius >= 0, limit_has_points(node));
            for (int k = 0; limit_has_points(node) && k < 4; k++) {
                double world[3];
                struct limit_place at = {i, node->rotation, k & 1, k >> 1};
                struct limit_point p;
                for (int a = 0; a < 3; a++)
                    world[a] = node->origin[a] + (double)made.heads[i].corner[a][k];
                assert_true(limit_evaluate_at(&made, &at, &p));
                assert_true(is_near(world, p.s, 1e-6 * size));
            }
            for (int k = 0; limit_has_points(node) && k < 25; k++) {
                struct limit_place at = {i, 0, k % 5 / 4.0, k / 5 / 4.0};
                struct limit_point p;
                assert_true(limit_evaluate_at(&made, &at, &p));
                assert_true(is_near(node->origin, p.s, (double)made.whole[i].radius));
            }
        }
        limit_tables_finish(&made);
    }
}

/* A walk over the surface in small steps, with jumps: a patch that is found again, with the points that it has, is that
 * which is found anew. */
static void test_found_again(void **state)
{
    (void)state;
    srand(11);
    for (size_t m = 0; m < sizeof MODELS / sizeof *MODELS; m++) {
        struct limit_tables stored, made;
        build_both(MODELS[m], &stored, &made);
        struct limit_patch again = {.node = NULL}, anew;
        struct limit_place place = {.node = 0};
        unsigned kept = 0;
        for (int step = 0; step < 3000; step++) {
            if (step % 10 == 0)
                place = (struct limit_place){(uint32_t)rand() % (uint32_t)made.n_faces,
                                             (unsigned)rand() & 3, (rand() % 1000) / 999.0,
                                             (rand() % 1000) / 999.0};
            place.a = fmin(fmax(place.a + (rand() % 100 - 50) * 1e-3, 0), 1);
            place.b *= step % 3 ? 0.5 : 1;
            const struct limit_node *node = again.node;
            int level = again.level;
            bool found = limit_patch_find(&made, &place, &anew);
            assert_int_equal(limit_patch_find_again(&made, &place, &again), found);
            if (!found)
                continue;
            struct limit_point a, b;
            limit_patch_evaluate(&made, &anew, &a);
            limit_patch_evaluate(&made, &again, &b);
            assert_memory_equal(&a, &b, offsetof(struct limit_point, has_normal));
            kept += again.node == node && again.level == level;
        }
        assert_true(kept > 500);
        finish_both(&stored, &made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_points),
        cmocka_unit_test(test_heads),
        cmocka_unit_test(test_found_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
