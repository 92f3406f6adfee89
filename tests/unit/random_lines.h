/* Random numbers and random lights around a model, for tests of lines. The same state gives the same numbers. */
#ifndef SHEEN_TESTS_RANDOM_LINES_H
#define SHEEN_TESTS_RANDOM_LINES_H

#include <stdint.h>

#include "server/curves/line_position.h"

static uint64_t random_state;

static inline double random_number(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (double)(random_state >> 11) * 0x1p-53;
}

static inline double random_signed(void)
{
    return 2 * random_number() - 1;
}

/* Families and lights in turn, at random places around a model of about unit size. */
static inline void random_map(unsigned kind, double size, struct line_map *map)
{
    static const enum line_family FAMILIES[] = {LINES_REFLECTION, LINES_HIGHLIGHT, LINES_ISOPHOTE,
                                                LINES_ZEBRA, LINES_ENVIRONMENT};
    struct lines lines = {.family = FAMILIES[kind % 5]};
    struct light light = {.kind = (enum light_kind)(kind / 5 % 4)};
    lines.eye_kind = kind & 1 ? LINE_EYE_POINT : LINE_EYE_DIRECTION;
    lines.has_direction = lines.family != LINES_ISOPHOTE || (kind & 2);
    for (int k = 0; k < 3; k++) {
        lines.direction[k] = random_signed();
        lines.eye[k] = 3 * size * random_signed();
        light.centre[k] = 0.3 * size * random_signed();
        light.u[k] = size * random_signed();
        light.v[k] = size * random_signed();
    }
    lines.eye[2] += 4 * size;
    light.centre[2] += light.kind == LIGHT_RECTANGLE || light.kind == LIGHT_PLANE ? 3 * size : 0;
    light.one_sided = kind % 3 == 0 && light.kind < LIGHT_TUNNEL;
    if (light.kind == LIGHT_TUNNEL)
        for (int k = 0; k < 3; k++)
            light.u[k] *= 4;
    if (light.kind == LIGHT_RECTANGLE)
        for (int k = 0; k < 3; k++)
            light.u[k] *= 3, light.v[k] *= 3;
    light.pattern.rotation_deg = kind % 7 == 3 ? 90 : 0;
    line_map_init(map, &lines, &light);
}

#endif
