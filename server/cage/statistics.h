/* Counts what a cage consists of, for `sheen info`: faces by size, edges and vertices at which
 * lines may bend, and tags. Only reads the cage. Any thread. */
#ifndef SHEEN_CAGE_STATISTICS_H
#define SHEEN_CAGE_STATISTICS_H

#include "server/cage/cage.h"

#define CAGE_MAX_VALENCES 64

struct cage_statistics {
    /* Of a model of patches only these are counted: its patches, the edges at which one ends
     * without a neighbour, and those at which three or more patches meet, or two that are wound
     * differently. */
    uint32_t n_patches;
    uint32_t n_triangles, n_quads, n_ngons; /* faces of 3, 4, and 5 or more corners */
    uint32_t n_boundary_edges;              /* edges with one face */
    uint32_t n_boundary_extraordinary;      /* vertices on such edges that do not have 2 faces */
    /* Edges with 3 or more faces, or traversed in the same direction by 2. */
    uint32_t n_nonmanifold_edges;
    /* Vertices on such an edge, or whose faces are not a single fan. */
    uint32_t n_nonmanifold_vertices;

    /* Tagged edges: infinitely sharp; of finite sharpness. */
    uint32_t n_sharp_edges, n_semisharp_edges;
    uint32_t n_sharp_vertices; /* tagged vertices, of any sharpness */
    uint32_t n_holes;          /* faces tagged as holes */

    /* Interior vertices that do not have 4 faces, by number of faces, ascending. If there are more
     * numbers than entries, the last entry counts all the rest, under the smallest of their
     * numbers. */
    uint32_t n_valences;
    struct {
        uint32_t valence, count;
    } extraordinary[CAGE_MAX_VALENCES];
};

/* `cage` has passed cage_check(). ERROR_SERVER when memory is short. */
bool cage_statistics(const struct cage *cage, struct cage_statistics *statistics,
                     struct error *error);

#endif
