#include "server/limit/bound.h"

double bound_weigh(struct vec offset, struct vec normal)
{
    const double along = 0.25;
    double n2 = vec_dot(normal, normal), across = vec_dot(offset, normal);
    double rest = sqrt(fmax(vec_dot(offset, offset) - across * across, 0));
    return n2 > 0 ? fabs(across) + along * rest : rest;
}

/* Twice the area of a cell as a vector across it. */
static struct vec cell_normal(const struct vec *p, int size)
{
    return vec_cross(vec_sub(p[size + 1], p[0]), vec_sub(p[size], p[1]));
}

struct vec bound_normal(const struct vec *grid, int size, bool without_first)
{
    const double cos45 = 0.70710678;
    struct vec sum = {0, 0, 0};
    for (int k = without_first ? 1 : 0; k < (size - 1) * (size - 1); k++)
        sum = vec_add(sum, cell_normal(grid + k / (size - 1) * size + k % (size - 1), size));
    double length = vec_length(sum);
    for (int k = without_first ? 1 : 0; k < (size - 1) * (size - 1); k++) {
        struct vec n = cell_normal(grid + k / (size - 1) * size + k % (size - 1), size);
        if (!(vec_dot(n, sum) > cos45 * vec_length(n) * length))
            return (struct vec){0, 0, 0};
    }
    return vec_scale(sum, 1 / length);
}

struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first,
                                 struct vec normal)
{
    double radius = 0, along_u = 0, along_v = 0, mixed = 0, border = 0;
    for (int j = 0; j < size; j++) {
        for (int i = 0; i < size; i++) {
            const struct vec *p = grid + j * size + i;
            if (without_first && p == grid)
                continue;
            radius = fmax(radius, vec_length(*p));
            bool left = i > 0 && !(without_first && j == 0 && i == 1);
            bool below = j > 0 && !(without_first && i == 0 && j == 1);
            if (left && i + 1 < size) {
                struct vec d = vec_add(vec_sub(p[-1], p[0]), vec_sub(p[1], p[0]));
                along_u = fmax(along_u, bound_weigh(d, normal));
                border = fmax(border, vec_length(d));
            }
            if (below && j + 1 < size) {
                struct vec d = vec_add(vec_sub(p[-size], p[0]), vec_sub(p[size], p[0]));
                along_v = fmax(along_v, bound_weigh(d, normal));
                border = fmax(border, vec_length(d));
            }
            if (i > 0 && j > 0 && !(without_first && i == 1 && j == 1)) {
                struct vec right = vec_sub(p[0], p[-1]);
                struct vec other = vec_sub(p[-size], p[-size - 1]);
                mixed = fmax(mixed, bound_weigh(vec_sub(right, other), normal));
            }
        }
    }
    double bend = fmax(along_u + 2 * mixed + along_v, border);
    return (struct limit_bound){(float)(radius * 1.000001), (float)(bend * 1.000001)};
}
