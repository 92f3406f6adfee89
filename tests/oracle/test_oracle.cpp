/* test_oracle: judges the oracle itself by closed forms. */
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/verdict.h"

namespace
{

/* A cage with the memory that it refers to. */
struct built_cage {
    std::vector<std::array<double, 3>> points;
    std::vector<uint32_t> start = {0}, corners;
    std::vector<cage_crease> creases;
    std::vector<cage_corner> sharp;
    std::vector<uint32_t> holes;
    cage_boundary boundary = CAGE_BOUNDARY_EDGE_ONLY;

    void face(const std::vector<uint32_t> &vertices)
    {
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        start.push_back((uint32_t)corners.size());
    }
    cage view()
    {
        cage cage = {};
        cage.n_vertices = points.size();
        cage.position = reinterpret_cast<double(*)[3]>(points.data());
        cage.n_faces = start.size() - 1;
        cage.face_start = start.data();
        cage.face_vertex = corners.data();
        cage.boundary = boundary;
        cage.n_creases = creases.size();
        cage.crease = creases.data();
        cage.n_corners = sharp.size();
        cage.corner = sharp.data();
        cage.n_holes = holes.size();
        cage.hole = holes.data();
        return cage;
    }
};

/* B-spline coefficients of 1, x, x^2, x^3 at integer knots, and those monomials' derivatives. */
double coefficient(int power, double i)
{
    const double c[4] = {1, i, i * i - 1.0 / 3, i * i * i - i};
    return c[power];
}
double monomial(int power, int derivative, double x)
{
    double factor = 1;
    for (int k = 0; k < derivative; k++)
        factor *= power - k;
    return power < derivative ? 0 : factor * std::pow(x, power - derivative);
}

const double height_factor[4][4] = {{0.3, -0.2, 0.05, 0.01},
                                    {0.1, 0.07, -0.03, 0.004},
                                    {-0.06, 0.02, 0.01, -0.002},
                                    {0.01, -0.005, 0.003, 0.0007}};

/* A bicubic over [0, n]^2 as a grid of quads, and its height by (derivative in x, in y). */
double height(int dx, int dy, double x, double y)
{
    double sum = 0;
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++)
            sum += height_factor[a][b] * monomial(a, dx, x) * monomial(b, dy, y);
    return sum;
}

built_cage bicubic_grid(int n)
{
    built_cage cage;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++) {
            double z = 0;
            for (int a = 0; a < 4; a++)
                for (int b = 0; b < 4; b++)
                    z += height_factor[a][b] * coefficient(a, i) * coefficient(b, j);
            cage.points.push_back({(double)i, (double)j, z});
        }
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            uint32_t c = (uint32_t)(j * (n + 1) + i), above = (uint32_t)n + 1;
            cage.face({c, c + 1, c + 1 + above, c + above});
        }
    return cage;
}

void test_bicubic(verdict *verdict)
{
    const int n = 5;
    built_cage grid = bicubic_grid(n);
    osd_oracle oracle(grid.view());
    double worst = 0;
    for (int j = 1; j < n - 1; j++)
        for (int i = 1; i < n - 1; i++)
            for (int k = 0; k < 25; k++) {
                double u = k % 5 / 4.0, v = k / 5 / 4.0, x = i + u, y = j + v;
                osd_sample s;
                if (!oracle.evaluate((uint32_t)(j * n + i), u, v, &s))
                    worst = INFINITY;
                const vec3 off[6] = {
                    s.p - vec3{x, y, height(0, 0, x, y)},   s.du - vec3{1, 0, height(1, 0, x, y)},
                    s.dv - vec3{0, 1, height(0, 1, x, y)},  s.duu - vec3{0, 0, height(2, 0, x, y)},
                    s.duv - vec3{0, 0, height(1, 1, x, y)}, s.dvv - vec3{0, 0, height(0, 2, x, y)}};
                for (vec3 difference : off)
                    worst = std::fmax(worst, length(difference));
            }
    verdict->at_most(worst, 1e-12, "bicubic: position and derivatives to second order");
}

/* If boundary edges are infinitely sharp, the border is the B-spline curve of the border points. */
void test_boundary(verdict *verdict)
{
    built_cage grid = bicubic_grid(4);
    osd_oracle smooth(grid.view());
    osd_sample s;
    bool found = smooth.evaluate(1, 0.5, 0, &s);
    double z =
        (grid.points[0][2] + 23 * grid.points[1][2] + 23 * grid.points[2][2] + grid.points[3][2]) /
        48;
    verdict->check(found && length(s.p - vec3{1.5, 0, z}) < 1e-13, "border curve, edge only");
    found = smooth.evaluate(0, 0, 0, &s);
    verdict->check(found && length(s.p) > 0.05, "the corner is smooth, edge only");

    const auto &corner = grid.points[0];
    grid.boundary = CAGE_BOUNDARY_EDGE_AND_CORNER;
    osd_oracle pinned(grid.view());
    found = pinned.evaluate(0, 0, 0, &s);
    verdict->check(found && length(s.p - vec3{corner[0], corner[1], corner[2]}) < 1e-13,
                   "the corner is interpolated, edge and corner");

    grid.boundary = CAGE_BOUNDARY_NONE;
    osd_oracle bare(grid.view());
    verdict->check(!bare.evaluate(0, 0.5, 0.5, &s) && bare.evaluate(5, 0.5, 0.5, &s),
                   "no surface at the boundary, none");
}

built_cage cube()
{
    built_cage cage;
    for (int i = 0; i < 8; i++)
        cage.points.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
    for (const std::vector<uint32_t> &face : std::vector<std::vector<uint32_t>>{
             {4, 5, 7, 6}, {0, 2, 3, 1}, {1, 3, 7, 5}, {0, 4, 6, 2}, {0, 1, 5, 4}, {2, 6, 7, 3}})
        cage.face(face);
    return cage;
}

/* Limit masks of valence 3: 3/8 of the vertex, 1/6 of each edge neighbour, 1/24 of each face
 * neighbour. */
void test_cube(verdict *verdict)
{
    built_cage cage = cube();
    osd_oracle oracle(cage.view());
    osd_sample s;
    bool found = oracle.evaluate(0, 0, 0, &s); /* vertex 4 is at (-1,-1,1) */
    double c = 3.0 / 8 + (1.0 / 6) - (1.0 / 24);
    verdict->check(found && length(s.p - c * vec3{-1, -1, 1}) < 1e-13, "limit of a cube's corner");
    found = oracle.evaluate(0, 0.5, 0.5, &s);
    verdict->check(found && angle(s.normal(), {0, 0, 1}) < 1e-13, "normals point outwards");
    verdict->check(oracle.irregular().size() == 8 && oracle.irregular()[0].valence == 3,
                   "irregular vertices of a cube");
    cage.holes = {0};
    osd_oracle open(cage.view());
    verdict->check(!open.evaluate(0, 0.5, 0.5, &s) && open.evaluate(1, 0.5, 0.5, &s), "a hole");
}

/* If every edge is infinitely sharp, the surface is the polyhedron itself. */
void test_sharp(verdict *verdict)
{
    built_cage cage = cube();
    for (uint32_t a = 0; a < 8; a++) {
        cage.sharp.push_back({a, CAGE_SHARPNESS_INFINITE});
        for (uint32_t bit = 1; bit < 8; bit *= 2)
            if (!(a & bit))
                cage.creases.push_back({{a, a | bit}, CAGE_SHARPNESS_INFINITE});
    }
    osd_oracle oracle(cage.view());
    osd_sample s;
    bool found = oracle.evaluate(0, 0.3, 0.6, &s);
    verdict->check(found && length(s.p - vec3{-0.4, 0.2, 1}) < 1e-12, "a cube with sharp edges");
    cage.creases.clear();
    osd_oracle pinned(cage.view());
    found = pinned.evaluate(0, 0, 0, &s);
    verdict->check(found && length(s.p - vec3{-1, -1, 1}) < 1e-12, "sharp corners alone");
}

/* On a pentagon among quads, derivatives are by the Ptex face's own u and v. */
void test_ngon_derivatives(verdict *verdict)
{
    built_cage cage;
    cage.points.push_back({0, 0, 1.3});
    for (int k = 0; k < 5; k++)
        cage.points.push_back({std::cos(0.4 * M_PI * k), std::sin(0.4 * M_PI * k), 0.2 * k});
    cage.face({1, 2, 3, 4, 5});
    for (uint32_t k = 0; k < 5; k++)
        cage.face({0, 1 + (k + 1) % 5, 1 + k});
    osd_oracle oracle(cage.view());
    verdict->check(oracle.n_ptex_faces() == 20, "Ptex faces of n-gons");
    double worst = 0, h = 1e-4;
    for (uint32_t face = 0; face < 20; face++) {
        osd_sample s, right, left, upper, lower;
        if (!oracle.evaluate(face, 0.4, 0.3, &s) || !oracle.evaluate(face, 0.4 + h, 0.3, &right) ||
            !oracle.evaluate(face, 0.4 - h, 0.3, &left) ||
            !oracle.evaluate(face, 0.4, 0.3 + h, &upper) ||
            !oracle.evaluate(face, 0.4, 0.3 - h, &lower))
            worst = INFINITY;
        worst = std::fmax(worst, length(0.5 / h * (right.p - left.p) - s.du));
        worst = std::fmax(worst, length(0.5 / h * (upper.p - lower.p) - s.dv));
        worst = std::fmax(worst, length(0.5 / h * (right.du - left.du) - s.duu));
        worst = std::fmax(worst, length(0.5 / h * (upper.du - lower.du) - s.duv));
        worst = std::fmax(worst, length(0.5 / h * (upper.dv - lower.dv) - s.dvv));
    }
    verdict->at_most(worst, 1e-6, "derivatives on n-gons against differences");
}

void test_exact_region(verdict *verdict)
{
    verdict->check(osd_oracle_is_exact(0.5, 0.001) && osd_oracle_is_exact(0.001, 0.002) &&
                       !osd_oracle_is_exact(0.001, 0.0019) && !osd_oracle_is_exact(0.999, 0.001),
                   "region around corners that is left out");
}

} // namespace

int main()
{
    verdict verdict;
    test_bicubic(&verdict);
    test_boundary(&verdict);
    test_cube(&verdict);
    test_sharp(&verdict);
    test_ngon_derivatives(&verdict);
    test_exact_region(&verdict);
    return verdict.finish();
}
