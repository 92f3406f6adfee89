#include "tests/bench/sheet.h"

#include <cmath>

sheet::sheet(int n_columns, int n_rows, int every) : columns(n_columns), rows(n_rows)
{
    for (int j = 0; j <= rows; j++)
        for (int i = 0; i <= columns; i++) {
            double x = (double)i / rows, y = (double)j / rows;
            loose.position.push_back({x, y, 0.05 * std::sin(9 * x) * std::cos(7 * y)});
        }
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++)
            loose.faces.push_back(
                {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    /* Each block of 4 x 3 faces has room for one turned edge, whose vertices belong to no other
     * block's. */
    for (int j = 1; every && j + 3 <= rows; j += 3)
        for (int i = 1; i + 4 <= columns; i += 4)
            if (loose.faces.size() >= (turned + 1) * (size_t)every)
                turn(i, j);
}

/* The edge between face (i, j) and the next one is turned by one corner: its old ends lose a face
 * each, and its new ends gain one. */
void sheet::turn(int i, int j)
{
    size_t face = (size_t)(j * columns + i);
    uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 2, j);
    uint32_t d = vertex(i + 2, j + 1), e = vertex(i + 1, j + 1), f = vertex(i, j + 1);
    loose.faces[face] = {a, b, c, f};
    loose.faces[face + 1] = {c, d, e, f};
    turned++;
}

std::shared_ptr<const struct cage> sheet::cage() const
{
    auto solid = std::make_shared<solid_cage>(loose);
    return {solid, &solid->cage};
}

void sheet::look_down(vec3 place, double distance, camera *camera)
{
    const double target[3] = {place.x, place.y, place.z}, up[3] = {0, 1, 0};
    for (int k = 0; k < 3; k++) {
        camera->eye[k] = camera->target[k] = target[k];
        camera->up[k] = up[k];
    }
    camera->eye[2] += distance;
    camera->fov_deg = 35;
}

void sheet::close_up(double distance, camera *camera) const
{
    look_down(loose.position[vertex(3, 1)], distance, camera);
}

void sheet::fill_view(camera *camera) const
{
    look_down({0.5 * columns / rows, 0.5, 0}, 1.2, camera);
}
