/* The arithmetic of crease sharpness, which all subdivision schemes share: how a step reduces it,
 * and how rules blend when it runs out.
 *
 * Sharpness is from 0 (smooth) to CAGE_SHARPNESS_INFINITE, in single precision as in OpenSubdiv
 * (sdc/crease.h); "semi-sharp" means above 0 and below infinite. A subdivision step takes 1 away
 * (DeRose, Kass and Truong 1998, section 3 and appendix B). Pure, any thread, cannot fail. */
#ifndef SHEEN_SURFACE_TOPOLOGY_SHARPNESS_H
#define SHEEN_SURFACE_TOPOLOGY_SHARPNESS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/cage/cage.h"

static inline bool sharpness_is_infinite(float sharpness)
{
    return sharpness >= CAGE_SHARPNESS_INFINITE;
}

static inline bool sharpness_is_semisharp(float sharpness)
{
    return sharpness > 0 && !sharpness_is_infinite(sharpness);
}

/* The sharpness of a vertex, or of an edge under the uniform rule, after one step: 1 less, but not
 * below 0; infinite stays infinite. */
float sharpness_child(float sharpness);

/* The semi-sharp edges around a vertex: the sum of their sharpness, and their number. Zero it
 * first. The sum is rounded, so the order of additions affects its last bit. */
struct sharpness_sum {
    float sum;
    uint32_t n;
};
/* Adds an edge if it is semi-sharp. */
void sharpness_add(struct sharpness_sum *sum, float sharpness);

/* The sharpness of one half of an edge after one step under Chaikin's rule, at the vertex where the
 * half ends: 3/4 of the edge's own sharpness and 1/4 of the mean of the other semi-sharp edges
 * there, minus 1 (DeRose, Kass and Truong 1998, appendix B, for two edges; OpenSubdiv
 * sdc/crease.cpp for any number). `sum` has all semi-sharp edges of the vertex, including this
 * one. */
float sharpness_child_chaikin(float sharpness, const struct sharpness_sum *sum);

/* The weight of the crease rule for the new vertex on an edge, from 0 (none) to 1 (all). `child`
 * and `far` are the sharpness of the edge's two halves after the step. The weight is 1 if both
 * halves stay sharp, else the edge's own sharpness. That exceeds 1 only if Chaikin's rule takes
 * more than 1 from a sharp edge; OpenSubdiv then uses a weight above 1, too (sdc/scheme.h,
 * ComputeEdgeVertexMask). */
double sharpness_crease_weight(float sharpness, float child, float far);

#endif
