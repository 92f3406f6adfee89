/* Three doubles and the oracles' operations on them. Deliberately independent of server/surface. */
#ifndef SHEEN_TESTS_ORACLE_VEC_H
#define SHEEN_TESTS_ORACLE_VEC_H

#include <cmath>

struct vec3 {
    double x = 0, y = 0, z = 0;
};

inline vec3 operator+(vec3 a, vec3 b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vec3 operator-(vec3 a, vec3 b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vec3 operator*(double s, vec3 a)
{
    return {s * a.x, s * a.y, s * a.z};
}
inline double dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline vec3 cross(vec3 a, vec3 b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(vec3 a)
{
    return std::sqrt(dot(a, a));
}
inline vec3 normalized(vec3 a)
{
    return (1 / length(a)) * a;
}
inline bool finite(vec3 a)
{
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
/* The angle in [0, pi] rad, accurate for small angles and any lengths. */
inline double angle(vec3 a, vec3 b)
{
    return std::atan2(length(cross(a, b)), dot(a, b));
}

#endif
