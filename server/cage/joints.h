/* Finds which boundary curves of a model's patches are equal, by geometry: two curves are joined if
 * their Bezier points agree within a tolerance. (server/curves/breaks/joints.h is another thing: it
 * finds border edges of any surface that lie nearly together.) Any thread. */
#ifndef SHEEN_CAGE_JOINTS_H
#define SHEEN_CAGE_JOINTS_H

#include "server/cage/cage.h"

/* The value of cage_joints.across for an edge without a neighbour. */
#define CAGE_NO_PATCH UINT32_MAX

/* Edge e of a patch runs from its corner e to the next one; the corners are at (0,0) (1,0) (1,1)
 * (0,1). */
struct cage_joints {
    /* [n_patches]: patch << 2 | edge of the neighbour, which runs the other way, or CAGE_NO_PATCH.
     * If across[p][e] names q and f, then across[q][f] names p and e. */
    uint32_t (*across)[4];
    uint8_t *collapsed; /* [n_patches]: bit e: the edge is one point, such as a pole */
    /* Edges without a neighbour that are neither collapsed nor counted in n_tangled or
     * n_against. */
    uint32_t n_boundary;
    uint32_t n_tangled; /* edges at places where three or more edges lie together */
    /* Pairs of edges that lie together and run the same way: the patches are wound differently. */
    uint32_t n_against;
    /* The first patch with an edge counted in n_against; UINT32_MAX: none. */
    uint32_t first_against;
};

/* Finds the joints of a model's patches. Two points are equal if each coordinate differs by at most
 * 1e-9 of the diagonal of the box of all control points, plus 4e-15 of the largest coordinate.
 * Apart from sorting, the time is linear in the number of patches, because at most 256 comparisons
 * for each edge in the mean are made. Edges that are not compared stay unjoined. Returns false when
 * memory is short; nothing is to be finished then. */
bool cage_joints_find(struct cage_joints *joints, const struct cage *cage);
void cage_joints_finish(struct cage_joints *joints);
/* The main memory, in bytes, that cage_joints_find() takes for so many patches; the result is part
 * of it. */
size_t cage_joints_bytes(size_t n_patches);

/* The Bezier points of edge e, in its direction, of a patch's 16. */
void cage_patch_edge(double bezier[16][3], unsigned e, double out[4][3]);

#endif
