/* Crease sharpness in a ring: which rule a vertex follows, and how rules blend as sharpness runs out. The
 * rules are OpenSubdiv's (sdc/crease.h, sdc/scheme.h; DeRose, Kass and Truong 1998; README.md 5 of
 * server/surface). Pure; no failure. */
#ifndef SHEEN_SURFACE_SUBDIVISION_CREASE_H
#define SHEEN_SURFACE_SUBDIVISION_CREASE_H

#include "server/surface/subdivision/ring.h"

enum crease_rule { RULE_SMOOTH, RULE_DART, RULE_CREASE, RULE_CORNER };

/* Sharpness of edge k; the ends of an open ring are infinitely sharp. */
float crease_edge(const struct ring *ring, uint32_t k);

/* The sharpness of the half of edge k at this vertex after one step, by the uniform or Chaikin's rule
 * (server/surface/topology/sharpness.h). */
float crease_child(const struct ring *ring, uint32_t k);

/* How much of the crease rule the new vertex on edge k takes, 0 to 1 and rarely more
 * (sharpness_crease_weight()). Needs creases.far where creases.edge is set. */
double crease_edge_weight(const struct ring *ring, uint32_t k);

/* Sets what sharpness `out` has, one step after `in`. */
void crease_refine(const struct ring *in, struct ring *out);

/* Whether an edge or the vertex is semi-sharp: its rules will change in further steps. */
bool crease_is_semisharp(const struct ring *ring);

/* The rule that the vertex follows. For RULE_CREASE end[] are the edges of the crease, for RULE_DART
 * end[0] is its edge. Where several sheets meet, the sharp edges of all count, and a crease's ends are the
 * points of ring->sheets instead. */
enum crease_rule crease_vertex_rule(const struct ring *ring, uint32_t end[2]);

#endif
