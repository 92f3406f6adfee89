/* Finds border edges that lie together, each pair once: they are joints of the model, whose vertices its file did not
 * join, or faces of one non-manifold edge. Private to breaks*.c. Pure, any thread. */
#ifndef SHEEN_CURVES_BREAKS_JOINTS_H
#define SHEEN_CURVES_BREAKS_JOINTS_H

#include "server/curves/edges.h"
#include "server/surface/vec.h"

/* A border edge that was measured: its ends, and its middle between them. */
struct break_border {
    struct surface_border of;
    struct vec points[3];
    double length;
};

/* The most joints that are listed for so many borders: where more than three borders lie together, not all pairs
 * are. */
size_t breaks_most_joints(size_t n_borders);
/* The bytes that breaks_find_joints() takes while it works, beside the joints. */
size_t breaks_joints_bytes(size_t n_borders);

/* Two borders lie together if both ends and the middles are nearer than `distance`. Sets *joints, malloc'd, in the
 * order of borders; NULL and 0: there are none. False when memory is short. */
bool breaks_find_joints(const struct break_border *borders, size_t n_borders, double distance,
                        struct surface_edge **joints, size_t *n_joints);

#endif
