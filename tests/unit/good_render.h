/* A valid request, for tests that change one thing in it. */
#ifndef SHEEN_TESTS_UNIT_GOOD_RENDER_H
#define SHEEN_TESTS_UNIT_GOOD_RENDER_H

#include "protocol/messages/message.h"

static const sheen_Render GOOD = {
    .width_px = 640,
    .height_px = 480,
    .has_camera = true,
    .camera = {.has_eye = true,
               .eye = {3, -4, 2},
               .has_target = true,
               .has_up = true,
               .up = {0, 0, 1},
               .has_fov_deg = true,
               .fov_deg = 35},
    .lights_count = 1,
    .lights = {{.has_centre = true,
                .centre = {0, 0, 4},
                .has_u = true,
                .u = {4, 0, 0},
                .has_v = true,
                .v = {0, 4, 0},
                .has_pattern = true,
                .pattern = {.kind = sheen_PatternKind_PATTERN_STRIPES,
                            .has_count = true,
                            .count = 20,
                            .has_duty = true,
                            .duty = 0.5,
                            .has_foreground = true,
                            .foreground = {1, 1, 1, 1},
                            .has_background = true,
                            .background = {0, 0, 0, 1}}}},
    .has_miss = true,
    .has_empty = true,
    .planes = sheen_Plane_PLANE_COLOUR,
    .encoding = sheen_Encoding_ENCODING_ZSTD,
};

#endif
