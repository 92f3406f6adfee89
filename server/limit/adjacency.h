/* Which Ptex face lies across each edge of a Ptex face. */
#ifndef SHEEN_LIMIT_ADJACENCY_H
#define SHEEN_LIMIT_ADJACENCY_H

#include "server/limit/plan.h"

struct limit_adjacency adjacency_of(const struct limit_plan *plan, uint32_t ptex);

#endif
