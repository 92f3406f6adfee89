/* Moves a surface onto another one by a rigid motion: iterated closest points, from point to plane (Chen and Medioni
 * 1992), trimmed. Each round pairs samples of the moved surface with their counterparts, leaves out the tenth with the
 * largest distances, and solves for the motion to which first order makes the sum of squared distances along the
 * normals least. Directions in which the surface can slide along itself are not moved in, and are counted. */
#ifndef SHEEN_CURVES_COMPARE_ALIGN_H
#define SHEEN_CURVES_COMPARE_ALIGN_H

#include "server/curves/compare/closest.h"

enum { ALIGN_PAIRS = 20000, ALIGN_PAIRS_OF_SLICE = 20, ALIGN_ROUNDS = 10 };

/* A point of the moved surface; the distance of its counterpart along the counterpart's normal. */
struct align_pair {
    struct vec p, n;
    double distance;
    bool is_known;
};

struct alignment {
    struct align_pair *pairs; /* [ALIGN_PAIRS] */
    double *distances;        /* [ALIGN_PAIRS], to find the tenth */
    struct rigid_motion motion;
    double rms_before,
        rms_after; /* over the pairs that were used in the first and the last round */
    double size;   /* of the fixed surface */
    unsigned
        free_directions; /* in which the moved surface slides along itself, in the last round */
    bool is_done;
};

bool alignment_init(struct alignment *alignment, double size, struct error *error);
void alignment_finish(struct alignment *alignment);
/* Finds the pairs of one slice; any thread. */
void alignment_pair(struct alignment *alignment, const struct kept_surface *moved,
                    const struct surface_tree *fixed, const struct closest_rules *rules,
                    size_t slice);
/* Improves the motion by the pairs; sets is_done when it changes no more. One thread. */
void alignment_solve(struct alignment *alignment);
/* The angle of a rotation, degrees. */
double motion_angle_deg(const struct rigid_motion *motion);

#endif
