#include "server/limit/bound.h"

static double second(struct vec a, struct vec b, struct vec c)
{
    return vec_length(vec_add(vec_sub(a, b), vec_sub(c, b)));
}

struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first)
{
    double radius = 0, along_u = 0, along_v = 0, mixed = 0;
    for (int j = 0; j < size; j++) {
        for (int i = 0; i < size; i++) {
            const struct vec *p = grid + j * size + i;
            if (without_first && p == grid)
                continue;
            radius = fmax(radius, vec_length(*p));
            bool left = i > 0 && !(without_first && j == 0 && i == 1);
            bool below = j > 0 && !(without_first && i == 0 && j == 1);
            if (left && i + 1 < size)
                along_u = fmax(along_u, second(p[-1], p[0], p[1]));
            if (below && j + 1 < size)
                along_v = fmax(along_v, second(p[-size], p[0], p[size]));
            if (i > 0 && j > 0 && !(without_first && i == 1 && j == 1)) {
                struct vec right = vec_sub(p[0], p[-1]);
                struct vec other = vec_sub(p[-size], p[-size - 1]);
                mixed = fmax(mixed, vec_length(vec_sub(right, other)));
            }
        }
    }
    return (struct limit_bound){(float)(radius * 1.000001),
                                (float)((along_u + 2 * mixed + along_v) * 1.000001)};
}
