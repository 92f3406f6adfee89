#include "tests/oracle/fan.h"

#include <cmath>
#include <random>

namespace
{

const int reach = 2; /* quads from the vertex to the boundary */

} // namespace

/* Each sector's faces begin at another corner, so that tables must be rotated. */
uint32_t fan::corner(int sector) const
{
    return (uint32_t)(16 * sector + sector % 4);
}

fan::fan(const fan_shape &shape, uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> noise(-1, 1);
    int rays = shape.closed ? shape.sectors : shape.sectors + 1;
    double total = shape.closed ? 2 * M_PI : shape.sectors == 1 ? M_PI / 2 : M_PI;
    double step = total / shape.sectors, across = 0.1 * std::fmin(1, step);
    if (shape.gentle > 0)
        across = shape.gentle;
    auto add = [&](double x, double y) {
        double saddle = 0.3 * (x * x - 0.5 * y * y);
        double dx = across * noise(random), dy = across * noise(random), dz = noise(random);
        position.push_back(
            {x + dx, y + dy, shape.gentle > 0 ? saddle + shape.gentle * dz : 0.3 * dz});
        return (uint32_t)position.size() - 1;
    };
    add(0, 0);
    for (int k = 0; k < rays; k++)
        for (int i = 1; i <= reach; i++)
            add(i * std::cos(k * step), i * std::sin(k * step));
    auto on_ray = [&](int k, int i) { return i ? (uint32_t)(1 + reach * (k % rays) + i - 1) : 0u; };
    face_start.push_back(0);
    for (int k = 0; k < shape.sectors; k++) {
        uint32_t grid[reach + 1][reach + 1];
        for (int j = 0; j <= reach; j++)
            for (int i = 0; i <= reach; i++)
                grid[j][i] = j == 0   ? on_ray(k, i)
                             : i == 0 ? on_ray(k + 1, j)
                                      : add(i * std::cos(k * step) + j * std::cos((k + 1) * step),
                                            i * std::sin(k * step) + j * std::sin((k + 1) * step));
        for (int j = 0; j < reach; j++)
            for (int i = 0; i < reach; i++) {
                const uint32_t quad[4] = {grid[j][i], grid[j][i + 1], grid[j + 1][i + 1],
                                          grid[j + 1][i]};
                for (int c = 0; c < 4; c++)
                    face_vertex.push_back(quad[(c + 4 - k % 4) & 3]);
                face_start.push_back((uint32_t)face_vertex.size());
            }
    }
    for (const auto &crease : shape.creases)
        for (int i = 0; i < reach; i++)
            creases.push_back(
                {{on_ray(crease.first, i), on_ray(crease.first, i + 1)}, crease.second});
    sharp_vertex = {0, shape.sharpness};

    cage.n_vertices = position.size();
    cage.position = reinterpret_cast<double(*)[3]>(position.data());
    cage.n_faces = face_start.size() - 1;
    cage.face_start = face_start.data();
    cage.face_vertex = face_vertex.data();
    cage.boundary = CAGE_BOUNDARY_EDGE_ONLY;
    cage.n_creases = creases.size();
    cage.crease = creases.data();
    cage.n_corners = shape.sharpness > 0;
    cage.corner = &sharp_vertex;
}
