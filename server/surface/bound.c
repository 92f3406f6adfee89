#include "server/surface/bound.h"

/* The weight of a difference inside the surface (README.md 6.1): the part along the normal counts
 * fully, the part along the surface a quarter. This is a norm, so bounds hold for it. */
static double weigh(struct vec offset, struct vec normal)
{
    const double along = 0.25;
    double across = vec_dot(offset, normal);
    double rest2 = vec_dot(offset, offset) - across * across;
    return fabs(across) + (rest2 > 0 ? along * sqrt(rest2) : 0);
}

/* The normal of a cell; its length is twice the cell's area. */
static struct vec cell_normal(const struct vec *p, int size)
{
    return vec_cross(vec_sub(p[size + 1], p[0]), vec_sub(p[size], p[1]));
}

/* The mean normal of a net. False if the normal of a cell deviates from it by more than 45
 * degrees. */
static bool find_normal(const struct vec *grid, int size, bool without_first, struct vec *normal)
{
    enum { MOST_CELLS = 16 };
    struct vec cell[MOST_CELLS], sum = {0, 0, 0};
    int n = 0;
    for (int k = without_first ? 1 : 0; k < (size - 1) * (size - 1); k++) {
        cell[n] = cell_normal(grid + k / (size - 1) * size + k % (size - 1), size);
        sum = vec_add(sum, cell[n++]);
    }
    double sum2 = vec_dot(sum, sum);
    for (int k = 0; k < n; k++) {
        double along = vec_dot(cell[k], sum);
        if (!(along > 0 && 2 * along * along > vec_dot(cell[k], cell[k]) * sum2))
            return false;
    }
    *normal = vec_scale(sum, 1 / sqrt(sum2));
    return true;
}

/* The largest differences, as lengths or weighed. */
struct bends {
    double u, v, mixed;
};

static inline struct vec second(struct vec before, struct vec at, struct vec after)
{
    return vec_add(vec_sub(before, at), vec_sub(after, at));
}

/* fmax() would be a function call; NaN does not occur here. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Keeps the largest difference so far: its squared length, and, with a normal, its weighed
 * length. */
static inline void add(double *plain2, double *across, struct vec offset, const struct vec *normal)
{
    *plain2 = larger(*plain2, vec_dot(offset, offset));
    if (normal)
        *across = larger(*across, weigh(offset, *normal));
}

struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first, bool weighed)
{
    struct vec normal;
    struct bends plain = {0, 0, 0}, across = {0, 0, 0};
    bool by_normal = weighed && find_normal(grid, size, without_first, &normal);
    double radius2 = 0;
    for (int j = 0; j < size; j++) {
        for (int i = 0; i < size; i++) {
            const struct vec *p = grid + j * size + i;
            if (without_first && p == grid)
                continue;
            radius2 = larger(radius2, vec_dot(*p, *p));
            bool left = i > 0 && !(without_first && j == 0 && i == 1);
            bool below = j > 0 && !(without_first && i == 0 && j == 1);
            if (left && i + 1 < size)
                add(&plain.u, &across.u, second(p[-1], p[0], p[1]), by_normal ? &normal : NULL);
            if (below && j + 1 < size)
                add(&plain.v, &across.v, second(p[-size], p[0], p[size]),
                    by_normal ? &normal : NULL);
            if (i > 0 && j > 0 && !(without_first && i == 1 && j == 1))
                add(&plain.mixed, &across.mixed,
                    vec_sub(vec_sub(p[0], p[-1]), vec_sub(p[-size], p[-size - 1])),
                    by_normal ? &normal : NULL);
        }
    }
    plain = (struct bends){sqrt(plain.u), sqrt(plain.v), sqrt(plain.mixed)};
    const struct bends *inside = by_normal ? &across : &plain;
    const double up = 1.000001; /* more than the rounding to float */
    return (struct limit_bound){
        .radius = (float)(sqrt(radius2) * up),
        .u = (float)(inside->u * up),
        .mixed = (float)(inside->mixed * up),
        .v = (float)(inside->v * up),
        .border_u = (float)(plain.u * up),
        .border_v = (float)(plain.v * up),
    };
}
