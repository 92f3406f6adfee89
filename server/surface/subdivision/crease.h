/* Crease sharpness: which rule a vertex follows, how rules blend as sharpness decays, and what is
 * left of a ring once only infinite sharpness remains. The rules are OpenSubdiv's
 * (sdc/crease.h, sdc/scheme.h; DeRose, Kass and Truong 1998). */
#ifndef SHEEN_SURFACE_SUBDIVISION_CREASE_H
#define SHEEN_SURFACE_SUBDIVISION_CREASE_H

#include "server/surface/subdivision/ring.h"

enum crease_rule { RULE_SMOOTH, RULE_DART, RULE_CREASE, RULE_CORNER };

/* Sharpness of edge k; the ends of an open ring are infinitely sharp. */
float crease_edge(const struct ring *ring, uint32_t k);

/* What the half of edge k at this vertex has after one step: one less, or Chaikin's mean with the
 * other edges less one. Never below 0; infinite stays. */
float crease_child(const struct ring *ring, uint32_t k);

/* The same for edge k. Needs creases.far where creases.edge is set. */
double crease_edge_weight(const struct ring *ring, uint32_t k);

/* Fills out's sharpness from in's: one step further. */
void crease_refine(const struct ring *in, struct ring *out);

/* Whether an edge or the vertex is sharp but not infinitely so: rules will still change. */
bool crease_is_semisharp(const struct ring *ring);

/* The vertex rule and the two ends of a crease (RULE_CREASE), or the edge of a dart in end[0].
 * Where several sheets meet, all of them count, and a crease's ends are those of ring->sheets. */
enum crease_rule crease_vertex_rule(const struct ring *ring, uint32_t end[2]);

#endif
