#include "client/cli/turntable.h"

#include <math.h>
#include <string.h>

#define MARGIN 0.92 /* share of half the picture, as when the daemon frames a model */

static const double DEGREE = 3.14159265358979323846 / 180;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length_of(const double a[3])
{
    return hypot(hypot(a[0], a[1]), a[2]);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void unit(const double a[3], double out[3])
{
    double length = length_of(a);
    for (int i = 0; i < 3; i++)
        out[i] = a[i] / length;
}

/* Rotates by Rodrigues' formula; the axis has length 1. */
static void turn(const double v[3], const double axis[3], double angle, double out[3])
{
    double along = dot(axis, v), across[3];
    cross(axis, v, across);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] * cos(angle) + across[i] * sin(angle) + axis[i] * along * (1 - cos(angle));
}

void turntable_turn(const struct sheen_camera *start, const double axis[3], double angle,
                    struct sheen_camera *camera)
{
    double upright[3], arm[3], turned[3];
    unit(axis, upright);
    for (int i = 0; i < 3; i++)
        arm[i] = start->eye[i] - start->target[i];
    turn(arm, upright, angle, turned);
    *camera = *start;
    for (int i = 0; i < 3; i++)
        camera->eye[i] = start->target[i] + turned[i];
    /* An up that is not the axis (the camera may look along the axis) turns with the eye. */
    unit(start->up, arm);
    if (fabs(dot(arm, upright)) < 1)
        turn(start->up, upright, angle, camera->up);
}

/* The distance from `target` at which all circles of the box's corners about the axis lie inside
 * the picture. A point p is inside if |p across| <= tangent (distance + p forward); the greatest
 * difference on a circle has a closed form. */
static double distance_of(const double target[3], const double forward[3], const double up[3],
                          const double axis[3], const double box_min[3], const double box_max[3],
                          const double tangent[2])
{
    double across[2][3], upright[3], least = 0;
    unit(axis, upright);
    cross(forward, up, across[0]);
    unit(across[0], across[0]);
    cross(across[0], forward, across[1]);
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int i = 0; i < 3; i++)
            p[i] = (corner >> i & 1 ? box_max[i] : box_min[i]) - target[i];
        double height = dot(p, upright), arm[3];
        cross(upright, p, arm);
        for (int edge = 0; edge < 4; edge++) {
            double asks[3], aside[3];
            for (int i = 0; i < 3; i++)
                asks[i] =
                    (edge & 1 ? -1 : 1) * across[edge / 2][i] / tangent[edge / 2] - forward[i];
            cross(upright, asks, aside);
            least = fmax(least, height * dot(asks, upright) + length_of(arm) * length_of(aside));
        }
    }
    return least;
}

void turntable_fit(struct sheen_camera *camera, const double axis[3], const double box_min[3],
                   const double box_max[3], double aspect, const double *target)
{
    double forward[3], tangent_y = MARGIN * tan(0.5 * camera->fov_deg * DEGREE);
    const double tangent[2] = {tangent_y * aspect, tangent_y};
    for (int i = 0; i < 3; i++)
        forward[i] = camera->target[i] - camera->eye[i];
    double distance = length_of(forward);
    unit(forward, forward);
    double wanted = distance_of(target ? target : camera->target, forward, camera->up, axis,
                                box_min, box_max, tangent);
    if (target)
        memcpy(camera->target, target, sizeof(camera->target));
    if (wanted > 0 && (target || wanted > distance))
        distance = wanted;
    for (int i = 0; i < 3; i++)
        camera->eye[i] = camera->target[i] - distance * forward[i];
}
