#include "tests/oracle/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/oracle/render.h"

namespace
{

const double cell_px = 2;
const int probe = 4;                     /* cells of the probing grid that measures a square */
const int min_cells = 8, max_cells = 32; /* cells along one side of a square that is drawn */
const int max_depth = 24;                /* how often a face may be halved */

struct vertex {
    double x, y; /* samples */
    double depth;
    double u, v;
    bool in_front;
};

struct canvas {
    raster picture;
    projector camera;
    double nearest; /* points nearer than this depth count as behind the eye */
};

/* A square of a Ptex face in (u,v). */
struct square {
    uint32_t face;
    double u, v, size;
    int depth;
};

bool evaluate_at(const osd_oracle &oracle, const square &q, int i, int j, int n, vec3 *p)
{
    return oracle.evaluate(q.face, q.u + q.size * i / n, q.v + q.size * j / n, p);
}

/* Twice the signed area of the triangle a, b, (x, y). */
double edge(const vertex &a, const vertex &b, double x, double y)
{
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/* The range of samples whose centres lie in [low, high], clamped to [0, size). */
void sample_range(double low, double high, int size, int *first, int *last)
{
    *first = (int)std::ceil(std::clamp(low - 0.5, 0.0, (double)size));
    *last = (int)std::floor(std::clamp(high - 0.5, -1.0, size - 1.0));
}

void draw_triangle(canvas *canvas, uint32_t face, const vertex &a, const vertex &b, const vertex &c)
{
    double area = edge(a, b, c.x, c.y);
    if (area == 0 || !a.in_front || !b.in_front || !c.in_front)
        return;
    bool flat = canvas->camera.orthographic();
    const double inverse[3] = {flat ? 1 : 1 / a.depth, flat ? 1 : 1 / b.depth,
                               flat ? 1 : 1 / c.depth};
    raster &picture = canvas->picture;
    int x0, x1, y0, y1;
    sample_range(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), picture.width, &x0, &x1);
    sample_range(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), picture.height, &y0, &y1);
    const double scale = 1 / area; /* a sample's weights change by the same step along each row */
    const double step_a = scale * (b.y - c.y), step_b = scale * (c.y - a.y),
                 step_c = scale * (a.y - b.y);
    for (int y = y0; y <= y1; y++) {
        double wa = scale * edge(b, c, x0 + 0.5, y + 0.5);
        double wb = scale * edge(c, a, x0 + 0.5, y + 0.5);
        double wc = scale * edge(a, b, x0 + 0.5, y + 0.5);
        raster::sample *row = &picture.samples[(size_t)y * (size_t)picture.width];
        for (int x = x0; x <= x1; x++, wa += step_a, wb += step_b, wc += step_c) {
            if (wa < 0 || wb < 0 || wc < 0)
                continue;
            double ka = wa * inverse[0], kb = wb * inverse[1], kc = wc * inverse[2];
            double whole = 1 / (ka + kb + kc);
            double depth = (ka * a.depth + kb * b.depth + kc * c.depth) * whole;
            if (depth < row[x].depth)
                row[x] = {depth, face, (float)((ka * a.u + kb * b.u + kc * c.u) * whole),
                          (float)((ka * a.v + kb * b.v + kc * c.v) * whole)};
        }
    }
}

void draw_cells(canvas *canvas, const osd_oracle &oracle, const square &q, int n)
{
    std::vector<vertex> above, row((size_t)n + 1);
    for (int j = 0; j <= n; j++) {
        for (int i = 0; i <= n; i++) {
            vec3 p;
            evaluate_at(oracle, q, i, j, n, &p);
            projected at = canvas->camera.project(p);
            bool in_front = canvas->camera.orthographic() || at.depth > canvas->nearest;
            row[(size_t)i] = {at.x * raster_factor, at.y * raster_factor, at.depth,
                              q.u + q.size * i / n, q.v + q.size * j / n, in_front};
        }
        for (size_t i = 0; j > 0 && i < (size_t)n; i++) {
            draw_triangle(canvas, q.face, above[i], above[i + 1], row[i + 1]);
            draw_triangle(canvas, q.face, above[i], row[i + 1], row[i]);
        }
        above = row;
    }
}

/* The longest distance of neighbours on the probing grid, in px; infinite if some are behind the
 * eye, negative if none is in the picture. */
double measure(const canvas &canvas, const osd_oracle &oracle, const square &q)
{
    vec3 grid[probe + 1][probe + 1];
    for (int j = 0; j <= probe; j++)
        for (int i = 0; i <= probe; i++)
            if (!evaluate_at(oracle, q, i, j, probe, &grid[j][i]))
                return -1;
    vec3 centre = grid[probe / 2][probe / 2];
    double radius = 0, longest = 0;
    for (int k = 0; k < (probe + 1) * (probe + 1); k++)
        radius = std::max(radius, length(grid[k / (probe + 1)][k % (probe + 1)] - centre));
    /* Twice that, because the surface may bulge between the probes. */
    if (!canvas.camera.may_see(centre, 2 * radius))
        return -1;
    for (int j = 0; j <= probe; j++)
        for (int i = 0; i <= probe; i++) {
            projected at = canvas.camera.project(grid[j][i]);
            if (!canvas.camera.orthographic() && at.depth <= canvas.nearest)
                return INFINITY;
            projected left = canvas.camera.project(grid[j][std::max(i - 1, 0)]);
            projected lower = canvas.camera.project(grid[std::max(j - 1, 0)][i]);
            longest = std::max(longest, std::hypot(at.x - left.x, at.y - left.y));
            longest = std::max(longest, std::hypot(at.x - lower.x, at.y - lower.y));
        }
    return longest;
}

void draw_square(canvas *canvas, const osd_oracle &oracle, const square &q)
{
    double longest = measure(*canvas, oracle, q);
    if (longest < 0)
        return;
    double cells = std::max(std::ceil(probe * longest / cell_px), (double)min_cells);
    if (cells <= max_cells || q.depth == max_depth) {
        draw_cells(canvas, oracle, q, (int)std::min(cells, (double)max_cells));
        return;
    }
    double half = 0.5 * q.size;
    for (int k = 0; k < 4; k++)
        draw_square(canvas, oracle,
                    {q.face, q.u + (k & 1) * half, q.v + (k >> 1) * half, half, q.depth + 1});
}

} // namespace

raster rasterize(const osd_oracle &oracle, const view &view)
{
    canvas canvas = {raster(), projector(view), 1e-4 * length(view.target - view.eye)};
    canvas.picture.width = view.width_px * raster_factor;
    canvas.picture.height = view.height_px * raster_factor;
    canvas.picture.samples.assign((size_t)canvas.picture.width * (size_t)canvas.picture.height,
                                  {std::numeric_limits<double>::infinity(), no_face, 0, 0});
    for (uint32_t face = 0; face < oracle.n_ptex_faces(); face++)
        draw_square(&canvas, oracle, {face, 0, 0, 1, 0});
    return std::move(canvas.picture);
}
