/* The camera of a turntable: about one point and the model's up, from one distance.
 *
 * Lengths are the model's units, angles radians. Pure, any thread. */
#ifndef SHEEN_CLIENT_TURNTABLE_H
#define SHEEN_CLIENT_TURNTABLE_H

#include "client/lib/sheen.h"

/* Turns eye and up of `start` about the axis (of any length but 0) through its target. */
void turntable_turn(const struct sheen_camera *start, const double axis[3], double angle,
                    struct sheen_camera *camera);

/* Moves a perspective camera, which the daemon chose, along its line of sight for all of the box to
 * stay in the picture (of this width : height) however far it is turned, 4 % free at the edges that
 * are met. `target`: what to look at from then on, from the same side, as near as that allows;
 * NULL: camera's own, which it comes no nearer to. */
void turntable_fit(struct sheen_camera *camera, const double axis[3], const double box_min[3],
                   const double box_max[3], double aspect, const double *target);

#endif
