/* Three doubles by value: points and vectors, usually in world units. Pure, any thread. */
#ifndef SHEEN_SURFACE_VEC_H
#define SHEEN_SURFACE_VEC_H

#include <math.h>

struct vec {
    double x, y, z;
};

static inline struct vec vec_add(struct vec a, struct vec b)
{
    return (struct vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec vec_sub(struct vec a, struct vec b)
{
    return (struct vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec vec_scale(struct vec a, double s)
{
    return (struct vec){a.x * s, a.y * s, a.z * s};
}

/* a + s b */
static inline struct vec vec_mad(struct vec a, double s, struct vec b)
{
    return (struct vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double vec_dot(struct vec a, struct vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec vec_cross(struct vec a, struct vec b)
{
    return (struct vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vec_length(struct vec a)
{
    return sqrt(vec_dot(a, a));
}

/* The unit vector in the direction of a; zero if a is zero. */
static inline struct vec vec_unit(struct vec a)
{
    double length = vec_length(a);
    return length > 0 ? vec_scale(a, 1 / length) : a;
}

#endif
