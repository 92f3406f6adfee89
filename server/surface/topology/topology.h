/* Builds the connectivity of a cage (half_edges.h), with its tags. One thread. */
#ifndef SHEEN_SURFACE_TOPOLOGY_TOPOLOGY_H
#define SHEEN_SURFACE_TOPOLOGY_TOPOLOGY_H

#include "server/base/error.h"
#include "server/surface/topology/half_edges.h"

/* False with ERROR_SERVER when memory is short, or with ERROR_MODEL for a crease on no edge. `cage`
 * must outlive the topology. */
bool topology_init(struct topology *topology, const struct cage *cage, struct error *error);
void topology_finish(struct topology *topology);

#endif
