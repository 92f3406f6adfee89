/* Where on a light the ray of a surface point falls, in double precision: the formulas of
 * shaders/README.md (Families, Lights, Patterns), which the shaders compute in single precision.
 * Pure, any thread, cannot fail. */
#ifndef SHEEN_CURVES_LINE_POSITION_H
#define SHEEN_CURVES_LINE_POSITION_H

#include <stdbool.h>

#include "server/scene/scene.h"
#include "server/surface/vec.h"

/* A line family, its eye and one light, prepared for many points. */
struct line_map {
    enum line_family family;
    enum light_kind kind;
    bool has_direction, eye_is_point, one_sided;
    struct vec eye;    /* a point, or a unit direction of view */
    struct vec centre; /* of the light */
    struct vec axis;   /* unit: the normal of a rectangle or plane, else the axis */
    struct vec zero,
        next; /* unit: azimuth 0 and a quarter turn later; for planes the dual basis of u, v */
    struct vec direction;  /* unit: what an isophote compares with the normal */
    double radius;         /* of a tunnel */
    double width, height;  /* of the light, in its units (degrees at infinity) */
    bool s_wraps, t_wraps; /* 0 and 1 are one place */
    struct pattern pattern;
};

/* Where a ray falls. */
struct line_position {
    /* The ray meets the light. */
    bool met;
    /* s and t are known: the ray meets the light, or the plane of a rectangle beside the
     * rectangle. */
    bool known;
    double s, t;
    double tau; /* length of the ray; 0 for what is at infinity */
    /* The sine of the angle between the ray and the directions where s has no value: the axis of a
     * tunnel or sphere and of an environment, the plane of a rectangle or plane. 1 where there are
     * none. */
    double sine;
};

/* Prepares a light. `lines` has a line eye of its own (eye_kind is not LINE_EYE_CAMERA), and a
 * direction where the family needs one; u and v of the light are not parallel (request_check()). */
void line_map_init(struct line_map *map, const struct lines *lines, const struct light *light);

/* The unit direction in which the ray of the point x with the unit normal n runs to the light. Not
 * for isophotes, which have no rays. */
struct vec line_ray(const struct line_map *map, struct vec x, struct vec n);

/* The place of the point x with the unit normal n. */
struct line_position line_position_at(const struct line_map *map, struct vec x, struct vec n);

/* The number of spacings of the pattern from one place to another, both known: the shorter way
 * around where the light is closed. A spacing is a period; for single lines the least distance of
 * two neighbours (for one line, and for an image, the light's width). Never negative. */
double line_shift(const struct line_map *map, const struct line_position *from,
                  const struct line_position *to);

/* The same along one of the pattern's axes, and signed: the change of the number of spacings that
 * the lines across this axis count. Axis 1 exists for lattices alone. */
int line_axes(const struct line_map *map);
double line_change(const struct line_map *map, int axis, const struct line_position *from,
                   const struct line_position *to);

/* The places of two points a little before and behind x along the unit tangent `along`, where the
 * normal changes by `turn` for each unit of length. Returns their distance; 0 if no place
 * changes. */
double line_step(const struct line_map *map, struct vec x, struct vec n, struct vec along,
                 struct vec turn, struct line_position ends[2]);

/* By how many spacings line_shift() grows for each unit of length on the surface about x, in the
 * direction in which it grows fastest: 1 / this is the distance of two lines on the surface. `turn`
 * has the change of the normal along two perpendicular unit tangents, `along`. 0 where the place is
 * not known. */
double line_density(const struct line_map *map, struct vec x, struct vec n,
                    const struct vec along[2], const struct vec turn[2]);

#endif
