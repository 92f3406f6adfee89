#include "server/render/clusters.h"

#include <math.h>
#include <stdlib.h>

#include "server/surface/vec.h"

/* A factor larger than the effect of rounding on distances. */
static const double SLACK = 1 + 1e-6;

/* The bound of the whole node. */
static double radius_of(const struct limit_tables *tables, size_t node)
{
    return tables->whole[node].radius;
}

/* Encloses the nodes by a sphere about the middle of the box of their origins. */
static struct cluster enclose(const struct limit_tables *tables, size_t first, size_t end)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    struct cluster cluster = {.radius = -1};
    for (size_t i = first; i < end; i++) {
        const struct limit_node *node = &tables->nodes[i];
        for (int k = 0; k < 3 && limit_has_points(node); k++) {
            double x = node->origin[k]; /* finite, so no call of fmin() is needed */
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    }
    for (int k = 0; k < 3; k++)
        cluster.centre[k] = 0.5 * low[k] + 0.5 * high[k];
    for (size_t i = first; i < end; i++) {
        const struct limit_node *node = &tables->nodes[i];
        if (!limit_has_points(node))
            continue;
        struct vec away = {node->origin[0] - cluster.centre[0], node->origin[1] - cluster.centre[1],
                           node->origin[2] - cluster.centre[2]};
        double reach = SLACK * (vec_length(away) + radius_of(tables, i));
        cluster.radius = reach > cluster.radius ? reach : cluster.radius;
    }
    return cluster;
}

bool clusters_init(struct clusters *clusters, const struct limit_tables *tables,
                   struct error *error)
{
    clusters->n = (tables->n_nodes + CLUSTER_NODES - 1) / CLUSTER_NODES;
    clusters->cluster = malloc(clusters->n * sizeof *clusters->cluster);
    if (!clusters->cluster)
        return error_set(error, ERROR_SERVER, "out of memory for the clusters of a model");
    for (size_t k = 0; k < clusters->n; k++) {
        size_t first = k * CLUSTER_NODES, end = first + CLUSTER_NODES;
        clusters->cluster[k] =
            enclose(tables, first, end < tables->n_nodes ? end : tables->n_nodes);
    }
    return true;
}

void clusters_finish(struct clusters *clusters)
{
    free(clusters->cluster);
    *clusters = (struct clusters){0};
}
