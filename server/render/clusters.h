/* Spheres around runs of nodes. A tile that shows a few of a million faces skips whole runs that
 * lie outside, instead of asking every node. Pure: no GL here. */
#ifndef SHEEN_RENDER_CLUSTERS_H
#define SHEEN_RENDER_CLUSTERS_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/surface/tables.h"

/* Nodes follow each other as faces do in the file, which is mostly side by side. */
enum { CLUSTER_NODES = 64 };

/* Holds all the surface of nodes [CLUSTER_NODES k, CLUSTER_NODES (k + 1)). World, units. */
struct cluster {
    double centre[3];
    double radius; /* below 0: these nodes have no surface */
};

struct clusters {
    struct cluster *cluster; /* half a byte a node */
    size_t n;
};

/* False, with ERROR_SERVER, when memory is short. */
bool clusters_init(struct clusters *clusters, const struct limit_tables *tables,
                   struct error *error);
void clusters_finish(struct clusters *clusters);

#endif
