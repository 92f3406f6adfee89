/* Counts that say what a cage consists of, for `sheen info`: faces by size, edges and vertices
 * at which lines may bend, tags. The cage is only read; any thread. */
#ifndef SHEEN_CAGE_STATISTICS_H
#define SHEEN_CAGE_STATISTICS_H

#include "server/cage/cage.h"

#define CAGE_MAX_VALENCES 64

struct cage_statistics {
    uint32_t n_triangles, n_quads, n_ngons; /* faces of 3, 4, and 5 or more corners */
    uint32_t n_boundary_edges;              /* edges of one face */
    uint32_t n_boundary_extraordinary;      /* vertices on such edges in other than 2 faces */
    uint32_t n_nonmanifold_edges;    /* of 3 faces and more, or run in one direction by 2 faces */
    uint32_t n_nonmanifold_vertices; /* on such an edge, or with faces that are not one fan */

    uint32_t n_sharp_edges, n_semisharp_edges; /* tagged: infinitely sharp, and other creases */
    uint32_t n_sharp_vertices;                 /* tagged, infinitely sharp or not */
    uint32_t n_holes;                          /* faces tagged as holes */

    /* Vertices off the boundary in other than 4 faces, by number of faces, ascending. When there
     * are more numbers than entries the last entry counts the rest under the smallest of them. */
    uint32_t n_valences;
    struct {
        uint32_t valence, count;
    } extraordinary[CAGE_MAX_VALENCES];
};

/* `cage` has passed cage_check(). ERROR_SERVER when memory is short. */
bool cage_statistics(const struct cage *cage, struct cage_statistics *statistics,
                     struct error *error);

#endif
