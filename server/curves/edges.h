/* The edges and vertices of a surface where it is less than smooth, as its tables name them: creases, borders, and the
 * sectors of faces around extraordinary vertices. Pure, any thread. */
#ifndef SHEEN_CURVES_EDGES_H
#define SHEEN_CURVES_EDGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/surface/tables.h"

/* An edge with a face on either side. Places on it are `at` from 0, at corner `edge[0]` of face[0], to 1 at the next
 * corner. On the other face the same place is from + by * at along its edge. (A face that is part of an n-gon has
 * half an edge of the cage, beside the whole edge of a quad.) */
struct surface_edge {
    uint32_t face[2];
    uint8_t edge[2];
    uint8_t levels;  /* LIMIT_BORDER_SHARP, or the levels that a semi-sharp crease takes */
    bool is_bend;    /* two patches whose normals agree, and whose curvatures do not */
    bool has_dart;   /* an infinitely sharp crease that ends at one of its vertices */
    bool is_joint;   /* two borders that lie together: each has a curve of its own */
    bool is_flipped; /* the faces are wound against each other */
    double from, by;
};

/* An edge of one face, beyond which there is no surface. */
struct surface_border {
    uint32_t face;
    uint8_t edge;
};

/* Faces around a vertex, from one border or infinitely sharp crease to the next, or all of them. */
struct surface_sector {
    uint32_t face; /* the first, if there is one, counter-clockwise */
    uint8_t corner;
    bool is_closed; /* all faces around the vertex; at most one crease, which ends there */
    uint32_t n_faces;
};

struct surface_edges {
    struct surface_edge *creases; /* and bends, in the order of faces */
    struct surface_border *borders;
    struct surface_sector *sectors; /* of extraordinary vertices alone */
    size_t n_creases, n_borders, n_sectors;
};

/* Upper bounds of the numbers, and of the bytes that surface_edges_list() takes while it works. */
struct surface_edges_room {
    size_t creases, borders, sectors;
    uint64_t bytes;
};
struct surface_edges_room surface_edges_room(const struct limit_tables *tables);

/* Lists them. False with ERROR_SERVER when memory is short; there is then nothing to finish. */
bool surface_edges_list(struct surface_edges *edges, const struct limit_tables *tables,
                        struct error *error);
void surface_edges_finish(struct surface_edges *edges);

/* The next face counter-clockwise around the vertex at a corner of a face: sets both. False at a border. The corner
 * must be one of the cage's vertices or the centre of an n-gon. */
bool surface_next_around(const struct limit_tables *tables, uint32_t *face, unsigned *corner);

#endif
