/* Finds border edges that lie together, each pair once: they are joints of the model, whose
 * vertices its file did not join, or faces of one non-manifold edge. (server/cage/joints.h is
 * another thing: it finds boundary curves of patches that are equal.) Private to breaks*.c. Pure,
 * any thread. */
#ifndef SHEEN_CURVES_BREAKS_JOINTS_H
#define SHEEN_CURVES_BREAKS_JOINTS_H

#include "server/curves/edges.h"
#include "server/surface/vec.h"

/* A border edge that was measured: its ends, and its middle between them. `across` leads from the
 * middle to the middle of the opposite side of the face, without the component along the border's
 * chord: its length is the face's width. */
struct break_border {
    struct surface_border of;
    struct vec points[3], across;
    double length;
};

/* The most joints that are listed for so many borders: where more than three borders lie together,
 * not all pairs are. */
size_t breaks_most_joints(size_t n_borders);
/* The bytes that breaks_find_joints() takes while it works, beside the joints. */
size_t breaks_joints_bytes(size_t n_borders);

/* How near the ends and the middles of two borders must be, units. Where both faces lie on the same
 * side of the borders, as the two skins of a part with thickness do, another distance holds than
 * for faces that continue each other. */
struct joint_distances {
    double same_side, continued; /* same_side <= continued */
};

/* The distances for a model: the larger of 10 times the limit of the gap and 1e-3 of the diagonal
 * of the model's box (same side: 1e-4), so that a stricter limit finds the same joints. */
struct joint_distances breaks_joint_distances(double gap_limit, double diagonal);

/* Finds the borders that lie together: both ends and the middles are nearer than the distance, and
 * than a quarter of the length of each border and of the width of its face, so that no border lies
 * on itself and no thin strip on its other side. Sets *joints, malloc'd, in the order of borders;
 * NULL and 0: there are none. False when memory is short. */
bool breaks_find_joints(const struct break_border *borders, size_t n_borders,
                        struct joint_distances distances, struct surface_edge **joints,
                        size_t *n_joints);

#endif
