/* Bounding spheres of runs of nodes. A tile that shows a few of a million faces skips whole runs
 * outside of it, instead of testing every node. Contains no GL. Pure, any thread. */
#ifndef SHEEN_RENDER_CLUSTERS_H
#define SHEEN_RENDER_CLUSTERS_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/surface/tables.h"

/* The nodes of a run. Nodes are in the order of the file's faces, which are usually neighbours. */
enum { CLUSTER_NODES = 64 };

/* A sphere that contains the surface of nodes CLUSTER_NODES k to CLUSTER_NODES (k + 1) - 1, in
 * world units. */
struct cluster {
    double centre[3];
    double radius; /* below 0: these nodes have no surface */
};

struct clusters {
    struct cluster *cluster; /* half a byte for each node */
    size_t n;
};

/* False with ERROR_SERVER when memory is short. */
bool clusters_init(struct clusters *clusters, const struct limit_tables *tables,
                   struct error *error);
void clusters_finish(struct clusters *clusters);

#endif
