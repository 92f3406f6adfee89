/* The arithmetic of crease sharpness, the same for every subdivision scheme: what a step leaves of
 * it, and how rules blend as it runs out.
 *
 * Sharpness is 0 (smooth) to CAGE_SHARPNESS_INFINITE, in single precision as OpenSubdiv has it
 * (sdc/crease.h): "semi-sharp" is above 0 and below infinite. A step of subdivision takes 1 away
 * (DeRose, Kass and Truong 1998, section 3 and appendix B). Pure; any thread; no failure. */
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

/* The sharpness of a vertex, or of an edge under the uniform rule, after one step: one less, never
 * below 0; infinite stays. */
float sharpness_child(float sharpness);

/* The semi-sharp edges around a vertex: the sum of their sharpness and how many they are. Begins
 * with zeros. Rounds, so that the order in which edges are added shows in the last bit. */
struct sharpness_sum {
    float sum;
    uint32_t n;
};
/* Adds an edge if it is semi-sharp. */
void sharpness_add(struct sharpness_sum *sum, float sharpness);

/* The sharpness of one half of an edge after one step under Chaikin's rule, at the vertex that the
 * half ends at: a semi-sharp edge takes 3/4 of its own sharpness and 1/4 of the mean of the other
 * semi-sharp edges there, less 1 (DeRose, Kass and Truong 1998, appendix B, for two
 * edges; OpenSubdiv sdc/crease.cpp for any number). `sum` is of all semi-sharp edges of the vertex, this one included. */
float sharpness_child_chaikin(float sharpness, const struct sharpness_sum *sum);

/* How much of the crease rule the new vertex on an edge takes, 0 for none and 1 for all: `child`
 * and `far` are what the edge's two halves have after the step. It is 1 where both halves stay
 * sharp, else the edge's own sharpness. That exceeds 1 only where Chaikin's rule takes more than 1
 * from a sharp edge; OpenSubdiv weighs by more than 1 then (sdc/scheme.h, ComputeEdgeVertexMask),
 * and so does this. */
double sharpness_crease_weight(float sharpness, float child, float far);

#endif
