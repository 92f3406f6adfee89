/* Tables of patches: joints found by geometry, borders by how smooth they are, and the surface against long double. Random
 * models have a seed of their own each. */
#include "server/cage/joints.h"
#include "server/surface/evaluate.h"
#include "server/surface/texels.h"
#include "tests/unit/cage_tables.h"

#include <string.h>

enum { N = 5, M = 7 }; /* patches around and along a torus */

static uint64_t state;

static double uniform(void)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-53; /* [0, 1) */
}

/* A cage without faces, which borrows its patches. */
static struct cage cage_of(struct cage_patch *patch, size_t n)
{
    static uint32_t start[1];
    return (struct cage){.face_start = start, .n_patches = n, .patch = patch};
}

/* A random periodic net of control points about a torus. */
static void random_net(double net[M][N][3])
{
    for (int y = 0; y < M; y++)
        for (int x = 0; x < N; x++) {
            double a = 2 * M_PI * x / N, b = 2 * M_PI * y / M, r = 1 + 0.2 * uniform();
            net[y][x][0] = (4 + r * cos(a)) * cos(b);
            net[y][x][1] = (4 + r * cos(a)) * sin(b);
            net[y][x][2] = r * sin(a) + 0.2 * uniform();
        }
}

/* The patch of B-spline points whose corner 0 is at (x,y) of the net. */
static struct cage_patch patch_of(double net[M][N][3], int x, int y)
{
    struct cage_patch patch = {.basis = CAGE_BSPLINE, .line = (uint32_t)(N * y + x)};
    for (int k = 0; k < 16; k++)
        memcpy(patch.point[k], net[(y + k / 4 - 1 + M) % M][(x + k % 4 - 1 + N) % N],
               sizeof patch.point[k]);
    return patch;
}

/* Turns a patch by quarters: its corner `turn` becomes corner 0. */
static struct cage_patch turned(const struct cage_patch *patch, unsigned turn)
{
    struct cage_patch out = *patch, in = *patch;
    for (; turn > 0; turn--, in = out)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 4; i++)
                memcpy(out.point[4 * j + i], in.point[4 * i + 3 - j], sizeof *out.point);
    return out;
}

/* Two patches with one boundary curve are neighbours, however they are turned, in whatever basis and order. Across the
 * joints of a B-spline the surface is smooth. */
static void test_joints_of_a_torus(void **unused)
{
    static const int step[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    (void)unused;
    for (state = 1; state < 20; state++) {
        struct cage_patch patch[N * M];
        unsigned turn[N * M];
        uint32_t at[N * M]; /* where the patch of the place (x,y) is */
        double net[M][N][3];
        uint64_t seed = state;
        random_net(net);
        for (uint32_t i = 0; i < N * M; i++)
            at[i] = i;
        for (uint32_t i = N * M - 1; i > 0; i--) {
            uint32_t other = (uint32_t)(uniform() * (i + 1)), kept = at[i];
            at[i] = at[other];
            at[other] = kept;
        }
        for (int i = 0; i < N * M; i++) {
            struct cage_patch own = patch_of(net, i % N, i / N);
            turn[i] = (unsigned)(uniform() * 4);
            own = turned(&own, turn[i]);
            if (uniform() < 0.5) {
                cage_patch_bezier(&own, patch[at[i]].point);
                patch[at[i]].basis = CAGE_BEZIER;
            } else {
                patch[at[i]] = own;
            }
        }
        struct cage cage = cage_of(patch, N * M);
        struct limit_tables tables;
        build_cage(&cage, true, &tables);
        assert_null(tables.bends);
        for (int i = 0; i < N * M; i++)
            for (unsigned e = 0; e < 4; e++) {
                int x = (i % N + step[e][0] + N) % N, y = (i / N + step[e][1] + M) % M;
                unsigned own = (e - turn[i]) & 3, there = (e + 2 - turn[N * y + x]) & 3;
                assert_int_equal(tables.adjacency[at[i]].across[own], at[N * y + x] << 2 | there);
                assert_int_equal(tables.nodes[at[i]].borders, 0);
            }
        limit_tables_finish(&tables);
        state = seed;
    }
}

/* Moves a row of points beside the boundary curve between two patches of a strip, and tells what its border becomes. */
static void test_smoothness(void **unused)
{
    static const struct {
        double second_row, third_row;
        unsigned borders;
        bool bends;
    } CASES[] = {{0, 0, 0, false},        {0, 1e-3, 0, true},   {0, 1e-9, 0, false},
                 {1e-3, 0, 15, false},    {1e-5, 0, 15, false}, {3e-8, 0, 0, false},
                 {-1e-2, 1e-2, 15, false}};
    (void)unused;
    for (size_t c = 0; c < sizeof CASES / sizeof *CASES; c++) {
        struct cage_patch patch[2] = {{.basis = CAGE_BEZIER}, {.basis = CAGE_BEZIER}};
        for (int p = 0; p < 2; p++)
            for (int k = 0; k < 16; k++) {
                double x = k % 4 / 3.0 + p, y = k / 4 / 3.0;
                /* x^2 in Bezier form: the coefficients of a function's second power. */
                double left = p, square = left * left + (k % 4) * 2 * left / 3 +
                                          (k % 4 == 2) / 3.0 + (k % 4 == 3);
                patch[p].point[k][0] = x;
                patch[p].point[k][1] = y;
                patch[p].point[k][2] = 0.3 * square;
            }
        for (int j = 0; j < 4; j++) {
            patch[1].point[4 * j + 1][2] += CASES[c].second_row;
            patch[1].point[4 * j + 2][2] += CASES[c].third_row;
        }
        struct cage cage = cage_of(patch, 2);
        struct limit_tables tables;
        build_cage(&cage, true, &tables);
        assert_int_equal(tables.adjacency[0].across[1], 1 << 2 | 3);
        assert_int_equal(tables.adjacency[1].across[3], 0 << 2 | 1);
        assert_int_equal(tables.nodes[0].borders, 0xf0f | CASES[c].borders << 4 | 0xf000);
        assert_int_equal(tables.nodes[1].borders, 0x0ff | 0xf00 | CASES[c].borders << 12);
        assert_true((tables.bends && tables.bends[0] >> 1 & 1) == CASES[c].bends);
        assert_true((tables.bends && tables.bends[1] >> 3 & 1) == CASES[c].bends);
        limit_tables_finish(&tables);
    }
}

/* A patch of the surface z = q0 x^2 + q1 x y + q2 y^2 with x = x0 + u and y = v + shear u. */
static struct cage_patch quadratic_patch(const double q[3], double x0, double shear)
{
    struct cage_patch patch = {.basis = CAGE_BEZIER};
    /* As a polynomial: 1, u, v, u^2, u v, v^2. */
    const double c[6] = {q[0] * x0 * x0,
                         2 * q[0] * x0 + q[1] * x0 * shear,
                         q[1] * x0,
                         q[0] + q[1] * shear + q[2] * shear * shear,
                         q[1] + 2 * q[2] * shear,
                         q[2]};
    for (int k = 0; k < 16; k++) {
        const int i = k % 4, j = k / 4;
        const double u = i / 3.0, v = j / 3.0, uu = i * (i - 1) / 6.0, vv = j * (j - 1) / 6.0;
        patch.point[k][0] = x0 + u;
        patch.point[k][1] = v + shear * u;
        patch.point[k][2] = c[0] + c[1] * u + c[2] * v + c[3] * uu + c[4] * u * v + c[5] * vv;
    }
    return patch;
}

/* Smoothness belongs to the surface: parameter lines that bend at a joint change nothing, and another curvature across
 * it is found in spite of them. */
static void test_smoothness_of_sheared_patches(void **unused)
{
    (void)unused;
    state = 4;
    for (int round = 0; round < 60; round++) {
        double q[3], other[3], shear = 2 * uniform() - 1;
        struct cage_patch patch[2];
        struct limit_tables tables;
        const bool bends = round & 1;
        for (int k = 0; k < 3; k++)
            q[k] = other[k] = 2 * uniform() - 1;
        patch[0] = quadratic_patch(q, -1, 0);
        other[0] += bends ? 0.1 : 0; /* x^2 vanishes with its slope at x = 0 */
        patch[1] = quadratic_patch(other, 0, shear);
        struct cage cage = cage_of(patch, 2);
        build_cage(&cage, true, &tables);
        assert_int_equal(tables.adjacency[0].across[1], 1 << 2 | 3);
        assert_int_equal(tables.nodes[0].borders >> 4 & 15, 0);
        assert_true((tables.bends && tables.bends[0] >> 1 & 1) == bends);
        limit_tables_finish(&tables);
    }
}

/* Poles have no neighbour and are no border; three patches along one curve are not joined. */
static void test_poles_and_tangles(void **unused)
{
    struct cage_patch patch[3];
    struct limit_tables tables;
    struct cage_joints joints;
    (void)unused;
    for (int p = 0; p < 3; p++) {
        patch[p] = (struct cage_patch){.basis = CAGE_BEZIER};
        for (int k = 0; k < 16;
             k++) { /* leaves of a book along the z axis, each closed to a point above */
            double r = k / 4 == 3 ? 0 : k % 4 / 3.0;
            patch[p].point[k][0] = r * cos(2 * p);
            patch[p].point[k][1] = r * sin(2 * p);
            patch[p].point[k][2] = k / 4;
        }
    }
    struct cage cage = cage_of(patch, 3);
    assert_true(cage_joints_find(&joints, &cage));
    assert_int_equal(joints.n_tangled, 3);
    assert_int_equal(joints.n_boundary, 6);
    assert_int_equal(joints.n_against, 0);
    for (int p = 0; p < 3; p++)
        assert_int_equal(joints.collapsed[p], 1 << 2);
    cage_joints_finish(&joints);
    build_cage(&cage, true, &tables);
    for (int p = 0; p < 3; p++) {
        for (int e = 0; e < 4; e++)
            assert_int_equal(tables.adjacency[p].across[e], LIMIT_NO_FACE);
        assert_int_equal(tables.nodes[p].borders, 0xf0ff);
    }
    limit_tables_finish(&tables);
}

/* --- joints against a comparison of every edge with every other one */

enum { MOST_PATCHES = 40, MOST_EDGES = 4 * MOST_PATCHES };

static bool are_near(const double a[3], const double b[3], double distance)
{
    return fabs(a[0] - b[0]) <= distance && fabs(a[1] - b[1]) <= distance &&
           fabs(a[2] - b[2]) <= distance;
}

/* As the header says: 1e-9 of the diagonal, and 4e-15 of the largest coordinate. */
static double joint_distance(const struct cage_patch *patch, int n)
{
    double diagonal = 0, largest = 0;
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < 16 * n; k++) {
            low = fmin(low, patch[k / 16].point[k % 16][i]);
            high = fmax(high, patch[k / 16].point[k % 16][i]);
        }
        diagonal = hypot(diagonal, high - low);
        largest = fmax(largest, fmax(fabs(low), fabs(high)));
    }
    return 1e-9 * diagonal + 4e-15 * largest;
}

/* Compares every edge with all others. Returns the number of edges that lie together with the one that most others do. */
static int expect_joints(struct cage_patch *patch, int n)
{
    static double edge[MOST_EDGES][4][3];
    int n_mates[MOST_EDGES] = {0}, mate[MOST_EDGES] = {0}, most = 0;
    bool along[MOST_EDGES] = {false};
    uint32_t boundary = 0, tangled = 0, against = 0, first = UINT32_MAX;
    const double distance = joint_distance(patch, n);
    struct cage cage = cage_of(patch, (size_t)n);
    struct cage_joints joints;
    for (int e = 0; e < 4 * n; e++)
        cage_patch_edge(patch[e / 4].point, (unsigned)e % 4, edge[e]);
    for (int a = 0; a < 4 * n; a++)
        for (int b = 0; b < 4 * n; b++) {
            bool same = a != b, opposite = a != b;
            for (int k = 0; k < 4; k++) {
                same = same && are_near(edge[a][k], edge[b][k], distance);
                opposite = opposite && are_near(edge[a][k], edge[b][3 - k], distance);
            }
            if (!same && !opposite)
                continue;
            n_mates[a]++;
            mate[a] = b;
            along[a] = same;
        }
    assert_true(cage_joints_find(&joints, &cage));
    for (int a = 0; a < 4 * n; a++) {
        bool is_pair = n_mates[a] == 1 && n_mates[mate[a]] == 1;
        boundary += n_mates[a] == 0;
        tangled += n_mates[a] > 0 && !is_pair;
        against += is_pair && along[a] && a < mate[a];
        if (is_pair && along[a] && (uint32_t)a / 4 < first)
            first = (uint32_t)a / 4;
        assert_int_equal(joints.across[a / 4][a % 4],
                         is_pair && !along[a] ? (uint32_t)mate[a] : CAGE_NO_PATCH);
        most = n_mates[a] > most ? n_mates[a] : most;
    }
    assert_int_equal(joints.n_boundary, boundary);
    assert_int_equal(joints.n_tangled, tangled);
    assert_int_equal(joints.n_against, against);
    assert_int_equal(joints.first_against, first);
    cage_joints_finish(&joints);
    return most;
}

/* A flat patch between four of the points, each moved in z by steps of `step`, 0 to `steps`. */
static struct cage_patch random_quad(double points[][3], int n_points, double step, int steps)
{
    struct cage_patch patch = {.basis = CAGE_BEZIER};
    double corner[4][3];
    int at[4];
    for (int c = 0; c < 4; c++) {
        bool is_new = false;
        while (!is_new) {
            at[c] = (int)(uniform() * n_points);
            is_new = true;
            for (int d = 0; d < c; d++)
                is_new = is_new && at[d] != at[c];
        }
        memcpy(corner[c], points[at[c]], sizeof corner[c]);
        corner[c][2] += step * floor(uniform() * (steps + 1));
    }
    for (int k = 0; k < 16; k++)
        for (int i = 0; i < 3; i++) {
            const double u = k % 4 / 3.0, v = k / 4 / 3.0;
            patch.point[k][i] = (1 - v) * ((1 - u) * corner[0][i] + u * corner[1][i]) +
                                v * ((1 - u) * corner[3][i] + u * corner[2][i]);
        }
    return patch;
}

/* Few points, so that many edges lie together. Up to nine patches have points in rows of steps that are a little more than
 * half the distance at which points are equal: two that both equal a third one may differ. Where more edges may lie
 * together than an edge looks for, all points of a group are equal. */
static void test_joints_against_all_pairs(void **unused)
{
    int most = 0;
    (void)unused;
    state = 11;
    for (int round = 0; round < 600; round++) {
        const bool is_row = round % 2;
        const int n = 1 + (int)(uniform() * (is_row ? 9 : MOST_PATCHES));
        const int n_points = 4 + (int)(uniform() * (round % 3 ? 6 : 60));
        struct cage_patch patch[MOST_PATCHES];
        double points[64][3];
        for (int k = 0; k < n_points; k++)
            for (int i = 0; i < 3; i++)
                points[k][i] = uniform();
        for (int p = 0; p < n; p++)
            patch[p] = random_quad(points, n_points, is_row ? 0.6e-9 : 1e-10, is_row ? 3 : 2);
        int n_mates = expect_joints(patch, n);
        most = n_mates > most ? n_mates : most;
    }
    assert_true(most > 25);
}

/* The faces of a regular cage, given as B-spline patches, have the same points bit for bit, and the same neighbours. */
static void test_faces_of_a_cage(void **unused)
{
    (void)unused;
    for (state = 1; state < 20; state++) {
        uint64_t seed = state;
        double net[M][N][3];
        uint32_t start[N * M + 1], vertex[4 * N * M];
        struct cage_patch patch[N * M];
        struct limit_tables of_cage, of_patches;
        random_net(net);
        for (uint32_t i = 0; i < N * M; i++) {
            uint32_t x = i % N, y = i / N, x1 = (x + 1) % N, y1 = (y + 1) % M;
            const uint32_t corner[4] = {N * y + x, N * y + x1, N * y1 + x1, N * y1 + x};
            start[i] = 4 * i;
            memcpy(vertex + 4 * i, corner, sizeof corner);
            patch[i] = patch_of(net, (int)x, (int)y);
        }
        start[N * M] = 4 * N * M;
        struct cage faces = {.n_vertices = N * M,
                             .position = &net[0][0],
                             .n_faces = N * M,
                             .face_start = start,
                             .face_vertex = vertex};
        struct cage patches = cage_of(patch, N * M);
        for (int stored = 0; stored < 2; stored++) {
            build_cage(&faces, stored, &of_cage);
            build_cage(&patches, stored, &of_patches);
            assert_int_equal(of_cage.n_texels, of_patches.n_texels);
            assert_memory_equal(of_cage.nodes, of_patches.nodes, N * M * sizeof *of_cage.nodes);
            assert_memory_equal(of_cage.heads, of_patches.heads, N * M * sizeof *of_cage.heads);
            assert_memory_equal(of_cage.whole, of_patches.whole, N * M * sizeof *of_cage.whole);
            assert_memory_equal(of_cage.adjacency, of_patches.adjacency,
                                N * M * sizeof *of_cage.adjacency);
            if (stored)
                assert_memory_equal(of_cage.texels, of_patches.texels,
                                    of_cage.n_texels * sizeof *of_cage.texels);
            for (uint32_t i = 0; i < N * M; i++) { /* on demand: what is made */
                struct limit_point a, b;
                assert_true(limit_evaluate(&of_cage, i, 0.3, 0.6, &a));
                assert_true(limit_evaluate(&of_patches, i, 0.3, 0.6, &b));
                assert_memory_equal(&a.s, &b.s, sizeof a.s);
                assert_memory_equal(&a.n, &b.n, sizeof a.n);
            }
            limit_tables_finish(&of_cage);
            limit_tables_finish(&of_patches);
        }
        state = seed;
    }
}

/* Position and normal of a Bezier patch by de Casteljau's algorithm in long double. */
struct exact {
    long double s[3], n[3];
};

static struct exact exact_at(const struct cage_patch *patch, long double u, long double v)
{
    long double d[3][3] = {{0}}; /* the point, its derivatives by u and v */
    struct exact out;
    for (int k = 0; k < 3; k++) {
        long double row[4][2];
        for (int j = 0; j < 4; j++) {
            long double p[4];
            for (int i = 0; i < 4; i++)
                p[i] = (long double)patch->point[4 * j + i][k];
            for (int r = 0; r < 2; r++)
                for (int i = 0; i < 3 - r; i++)
                    p[i] += u * (p[i + 1] - p[i]);
            row[j][0] = p[0] + u * (p[1] - p[0]);
            row[j][1] = 3 * (p[1] - p[0]);
        }
        for (int r = 0; r < 2; r++)
            for (int j = 0; j < 3 - r; j++)
                for (int i = 0; i < 2; i++)
                    row[j][i] += v * (row[j + 1][i] - row[j][i]);
        d[0][k] = row[0][0] + v * (row[1][0] - row[0][0]);
        d[1][k] = row[0][1] + v * (row[1][1] - row[0][1]);
        d[2][k] = 3 * (row[1][0] - row[0][0]);
    }
    long double length = 0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        out.s[k] = d[0][k];
        out.n[k] = d[1][a] * d[2][b] - d[1][b] * d[2][a];
        length = hypotl(length, out.n[k]);
    }
    for (int k = 0; k < 3; k++)
        out.n[k] /= length;
    return out;
}

/* Bezier patches of the bottle, at random places: B-spline points in single precision against long double. */
static void test_bottle_against_long_double(void **unused)
{
    static char bytes[1 << 16];
    struct cage cage;
    struct limit_tables tables;
    struct error error = {0};
    double position = 0, normal = 0, near_pole = 0, diagonal = 0;
    (void)unused;
    FILE *file = fopen("tests/models/bottle.bpt", "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_true(cage_read(&cage, bytes, size, "bottle.bpt", &error));
    assert_int_equal(cage.n_patches, 28);
    build_cage(&cage, true, &tables);
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, tables.box_max[k] - tables.box_min[k]);
    state = 3;
    for (int i = 0; i < 20000; i++) {
        const uint32_t f = (uint32_t)i % 28;
        const double u = uniform(), v = uniform();
        const struct exact exact = exact_at(&cage.patch[f], (long double)u, (long double)v);
        struct limit_point got;
        assert_true(limit_evaluate(&tables, f, u, v, &got));
        const double s[3] = {got.s.x, got.s.y, got.s.z}, n[3] = {got.n.x, got.n.y, got.n.z};
        double angle = 0;
        for (int k = 0; k < 3; k++) {
            position = fmax(position, fabs(s[k] - (double)exact.s[k]) / diagonal);
            angle = hypot(angle, n[k] - (double)exact.n[k]);
        }
        bool is_pole = f % 7 == 0; /* the bottom */
        if (is_pole)
            near_pole = fmax(near_pole, angle);
        else
            normal = fmax(normal, angle);
    }
    print_message("position %.2g of the diagonal; normals %.2g rad, of patches with a pole %.2g\n",
                  position, normal, near_pole);
    assert_true(position < 1e-6);
    assert_true(normal < 2e-6);
    assert_true(near_pole < 2e-6);
    limit_tables_finish(&tables);
    cage_finish(&cage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_joints_of_a_torus),
        cmocka_unit_test(test_smoothness),
        cmocka_unit_test(test_smoothness_of_sheared_patches),
        cmocka_unit_test(test_poles_and_tangles),
        cmocka_unit_test(test_joints_against_all_pairs),
        cmocka_unit_test(test_faces_of_a_cage),
        cmocka_unit_test(test_bottle_against_long_double),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
