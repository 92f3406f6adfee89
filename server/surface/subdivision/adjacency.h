/* Finds the Ptex face across each edge of a Ptex face (server/surface/node.h). Pure, any thread. */
#ifndef SHEEN_SURFACE_SUBDIVISION_ADJACENCY_H
#define SHEEN_SURFACE_SUBDIVISION_ADJACENCY_H

#include "server/surface/subdivision/plan.h"

struct limit_adjacency adjacency_of(const struct limit_plan *plan, uint32_t ptex);

#endif
