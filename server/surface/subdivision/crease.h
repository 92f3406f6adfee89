/* Crease sharpness in a ring: which rule a vertex follows, and how rules blend when sharpness runs
 * out. The rules are OpenSubdiv's (sdc/crease.h, sdc/scheme.h; DeRose, Kass and Truong 1998;
 * server/surface/README.md 5). Pure, any thread, cannot fail. */
#ifndef SHEEN_SURFACE_SUBDIVISION_CREASE_H
#define SHEEN_SURFACE_SUBDIVISION_CREASE_H

#include "server/surface/subdivision/ring.h"

enum crease_rule { RULE_SMOOTH, RULE_DART, RULE_CREASE, RULE_CORNER };

/* The sharpness of edge k; the ends of an open ring are infinitely sharp. */
float crease_edge(const struct ring *ring, uint32_t k);

/* The sharpness of the half of edge k at this vertex after one step, by the uniform or Chaikin's rule
 * (server/surface/topology/sharpness.h). */
float crease_child(const struct ring *ring, uint32_t k);

/* The weight of the crease rule for the new vertex on edge k, 0 to 1, rarely more
 * (sharpness_crease_weight()). Needs creases.far if creases.edge is set. */
double crease_edge_weight(const struct ring *ring, uint32_t k);

/* Sets the sharpness of `out`, one step after `in`. */
void crease_refine(const struct ring *in, struct ring *out);

/* True if an edge or the vertex is semi-sharp, so that rules will change in further steps. */
bool crease_is_semisharp(const struct ring *ring);

/* The rule that the vertex follows. end[] are the crease's edges for RULE_CREASE; end[0] is the
 * dart's edge for RULE_DART. If several sheets meet, the sharp edges of all of them count, and the
 * ends of a crease are the points in ring->sheets instead. */
enum crease_rule crease_vertex_rule(const struct ring *ring, uint32_t end[2]);

#endif
