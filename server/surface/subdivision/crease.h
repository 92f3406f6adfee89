/* Crease sharpness: which rule a vertex follows, how rules blend as sharpness decays, and what is
 * left of a ring once only infinite sharpness remains. The rules are OpenSubdiv's
 * (sdc/crease.h, sdc/scheme.h; DeRose, Kass and Truong 1998). */
#ifndef SHEEN_SURFACE_SUBDIVISION_CREASE_H
#define SHEEN_SURFACE_SUBDIVISION_CREASE_H

#include "server/surface/subdivision/ring.h"

enum crease_rule { RULE_SMOOTH, RULE_DART, RULE_CREASE, RULE_CORNER };

/* Sharpness of edge k; the ends of an open ring are infinitely sharp. */
float crease_edge(const struct ring *ring, uint32_t k);

/* The sum of the semi-sharp edges around a vertex, in the ring's order, for Chaikin's rule. Begins
 * with zeros. */
struct crease_sum {
    float sum;
    uint32_t n;
};
void crease_add(struct crease_sum *sum, float sharpness);
/* What becomes by Chaikin's rule of the half, at that vertex, of an edge among them. */
float crease_child_chaikin(float sharpness, const struct crease_sum *sum);

/* What the half of edge k at this vertex has after one step: one less, or Chaikin's mean with the
 * other edges less one. Never below 0; infinite stays. */
float crease_child(const struct ring *ring, uint32_t k);

/* How much of the crease rule the new vertex on an edge takes, by what its halves at both ends
 * become: all of it where both halves stay
 * sharp, else the sharpness. That is at most 1 but where Chaikin's mean wipes out a sharper edge;
 * OpenSubdiv then takes more than all (sdc/scheme.h, ComputeEdgeVertexMask given the child's rule),
 * and so do we. */
double crease_weight(float sharpness, float child, float far);

/* The same for edge k. Needs creases.far where creases.edge is set. */
double crease_edge_weight(const struct ring *ring, uint32_t k);

/* Sharpness of a vertex after one step. */
float crease_child_vertex(float sharpness);

/* Fills out's sharpness from in's: one step further. */
void crease_refine(const struct ring *in, struct ring *out);

/* Whether an edge or the vertex is sharp but not infinitely so: rules will still change. */
bool crease_is_semisharp(const struct ring *ring);

/* The vertex rule and the two ends of a crease (RULE_CREASE), or the edge of a dart in end[0].
 * Where several sheets meet, all of them count, and a crease's ends are those of ring->sheets. */
enum crease_rule crease_vertex_rule(const struct ring *ring, uint32_t end[2]);

/* A ring without semi-sharp tags, cut to the sector that holds the quad at ring->at: beyond an
 * infinitely sharp edge nothing matters. What stays is open, or closed and smooth, or closed with
 * one sharp edge (a dart), or closed with a sharp vertex, or has a foreign crease (ring.h). Rings
 * with semi-sharp tags stay whole. */
struct ring crease_settle(const struct ring *ring, struct arena *arena);

/* Settled, and with its quads plain B-spline patches (phantom points beyond a sector's end). Not so
 * the plain sectors of an extraordinary vertex: one patch carries 2^-24 of itself, and a camera
 * that looks at the whole vertex from nearby wants more. */
bool crease_is_regular(const struct ring *settled);

/* Whether the surface ends, as a sector, at the quad's first (0) or second (1) edge. */
bool crease_ends_at(const struct ring *settled, int edge);

#endif
