/* Finds which boundary curves of a model's patches are equal, by geometry: two curves are joined if their Bezier points
 * agree within a tolerance. Any thread. */
#ifndef SHEEN_CAGE_JOINTS_H
#define SHEEN_CAGE_JOINTS_H

#include "server/cage/cage.h"

/* The value of cage_joints.across for an edge without a neighbour. */
#define CAGE_NO_PATCH UINT32_MAX

/* Edge e of a patch runs from its corner e to the next one; the corners are at (0,0) (1,0) (1,1) (0,1). */
struct cage_joints {
    /* [n_patches]: patch << 2 | edge of the neighbour, which runs the other way, or CAGE_NO_PATCH. Each leads back. */
    uint32_t (*across)[4];
    uint8_t *collapsed; /* [n_patches]: bit e: the edge is one point, such as a pole */
    uint32_t
        n_boundary; /* edges without a neighbour that are not collapsed, apart from the following */
    uint32_t n_tangled; /* edges that lie together three or more */
    uint32_t
        n_against; /* pairs of edges that lie together and run the same way: the patches are wound differently */
    uint32_t first_against; /* the first patch with such an edge */
};

/* Finds the joints of a model's patches. Points within 1e-9 of the diagonal of the model's box are equal. Linear
 * in the number of patches but for sorting; where more than 256 edges in the mean have their middles at nearly the same place,
 * the rest stay unjoined. False: no memory; there is then nothing to finish. */
bool cage_joints_find(struct cage_joints *joints, const struct cage *cage);
void cage_joints_finish(struct cage_joints *joints);

/* The Bezier points of edge e, in its direction, of a patch's 16. */
void cage_patch_edge(double bezier[16][3], unsigned e, double out[4][3]);

#endif
