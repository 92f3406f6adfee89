/* Builds the connectivity of a cage (half_edges.h), with what its tags say. */
#ifndef SHEEN_SURFACE_TOPOLOGY_TOPOLOGY_H
#define SHEEN_SURFACE_TOPOLOGY_TOPOLOGY_H

#include "server/base/error.h"
#include "server/surface/topology/half_edges.h"

/* ERROR_SERVER when memory is short; ERROR_MODEL for a crease where no edge is. */
bool topology_init(struct topology *topology, const struct cage *cage, struct error *error);
void topology_finish(struct topology *topology);

#endif
