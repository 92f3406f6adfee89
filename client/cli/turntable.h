/* The camera of a turntable, which turns about the model's up axis through one point, at one
 * distance.
 *
 * Lengths are in the model's units, angles in radians. Pure, any thread. */
#ifndef SHEEN_CLIENT_TURNTABLE_H
#define SHEEN_CLIENT_TURNTABLE_H

#include "client/lib/sheen.h"

/* Turns eye and up of `start` by `angle` about `axis` (of any length but 0) through its target. */
void turntable_turn(const struct sheen_camera *start, const double axis[3], double angle,
                    struct sheen_camera *camera);

/* Moves a perspective camera, which the daemon chose, along its line of sight so that the whole box
 * stays in the picture (of aspect width / height) at every angle, with a margin of 4 %. `target` is
 * the point to look at from then on, from the same side, as near as possible; NULL: the camera's
 * own target, to which the camera does not come nearer. */
void turntable_fit(struct sheen_camera *camera, const double axis[3], const double box_min[3],
                   const double box_max[3], double aspect, const double *target);

#endif
