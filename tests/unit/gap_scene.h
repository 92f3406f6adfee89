/* Sheets side by side in front of a wall, whose borders are parallel and a third of a pixel apart,
 * for tests of pixels that look through the gap. */
#ifndef SHEEN_TESTS_GAP_SCENE_H
#define SHEEN_TESTS_GAP_SCENE_H

#include "server/scene/scene.h"
#include "tests/unit/cage_tables.h"

enum { SIDE_PX = 160, QUADS = 24, WALL = 14 };
static const double STEP_RAD = 0.1, RADIUS = 6;

/* The factor by which the limit curve of points on a circle is smaller than the circle, to 1e-6. */
static inline double gap_shrink(void)
{
    return (2 + cos(STEP_RAD)) / 3;
}

/* Two rows of quads on either side of a circle about the origin at z = 0, whose borders are `gap`
 * apart, in front of a wall of quads that overlap and are not connected, so that a ray must find
 * its own. Faces: the wall, WALL x WALL of them, the inner row, the outer row. */
static inline void gap_tables(struct limit_tables *tables, double gap)
{
    static char text[1 << 16];
    size_t used = 0;
    const int first = 4 * WALL * WALL + 1;
    const double radius[4] = {RADIUS - 2, (RADIUS - gap / 2) / gap_shrink(),
                              (RADIUS + gap / 2) / gap_shrink(), RADIUS + 2};
#define ADD(...) used += (size_t)snprintf(text + used, sizeof text - used, __VA_ARGS__)
    for (int k = 0; k < WALL * WALL; k++)
        for (int corner = 0; corner < 4; corner++)
            ADD("v %g %g %g\n", RADIUS - WALL / 2 + k % WALL + 1.2 * (corner == 1 || corner == 2),
                -WALL / 2 + k / WALL + 1.2 * (corner >= 2), -1 - 0.001 * k);
    for (int k = 0; k < WALL * WALL; k++)
        ADD("f %d %d %d %d\n", 4 * k + 1, 4 * k + 2, 4 * k + 3, 4 * k + 4);
    for (int i = 0; i <= QUADS; i++)
        for (int k = 0; k < 4; k++)
            ADD("v %.17g %.17g 0\n", radius[k] * cos(STEP_RAD * (i - QUADS / 2)),
                radius[k] * sin(STEP_RAD * (i - QUADS / 2)));
    for (int row = 0; row < 2; row++)
        for (int i = 0; i < QUADS; i++)
            ADD("f %d %d %d %d\n", first + 4 * i + 2 * row, first + 1 + 4 * i + 2 * row,
                first + 5 + 4 * i + 2 * row, first + 4 + 4 * i + 2 * row);
    ADD("t interpolateboundary 1/0/0 1\n"); /* keeps the positions of corner vertices */
#undef ADD
    build(text, used, tables);
}

/* A camera above, turned by `turn_rad`, with the gap's middle in the picture's middle. */
static inline struct camera gap_camera(double unit_px, double turn_rad)
{
    return (struct camera){.kind = CAMERA_ORTHOGRAPHIC,
                           .eye = {RADIUS, 0.01, 9},
                           .target = {RADIUS, 0.01, 0},
                           .up = {sin(turn_rad), cos(turn_rad), 0},
                           .ortho_height = SIDE_PX / unit_px};
}

/* Expects that every pixel shows what its centre sees, told by the faces, whose numbers are
 * `stride` apart. Counts the pixels that show the wall. The borders are circles up to a thousandth
 * of a pixel, so within a hundredth of a pixel of a border both sides are accepted. */
static inline size_t gap_expect_exact(const float (*position)[3], const uint32_t *faces,
                                      size_t stride, double unit_px, double gap)
{
    size_t n_wall = 0;
    for (size_t i = 0; i < SIDE_PX * SIDE_PX; i++) {
        double beyond = hypot(position[i][0], position[i][1]) - RADIUS;
        uint32_t face = faces[stride * i];
        bool is_wall = fabs(beyond) < gap / 2;
        if (face == UINT32_MAX)
            fail_msg("pixel %zu,%zu is empty", i % SIDE_PX, i / SIDE_PX);
        if (fabs(fabs(beyond) - gap / 2) * unit_px < 0.01 || fabs(beyond) > 1)
            continue;
        uint32_t row = face < WALL * WALL ? 2 : (face - WALL * WALL) / QUADS;
        if (row != (is_wall ? 2 : beyond > 0))
            fail_msg("pixel %zu,%zu shows face %u, %g px from the gap's middle", i % SIDE_PX,
                     i / SIDE_PX, face, beyond * unit_px);
        n_wall += is_wall;
    }
    return n_wall;
}

#endif
