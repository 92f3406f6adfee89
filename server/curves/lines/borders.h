/* Which borders of faces are one border of the surface, and which corners one vertex, so that what is found on a border
 * is found once. A border has an owner, which is an edge of one face; a vertex is named by its lowest corner. Where the
 * surface ends or has an infinitely sharp crease each face has a border of its own. */
#ifndef SHEEN_LINES_BORDERS_H
#define SHEEN_LINES_BORDERS_H

#include "server/surface/tables.h"

/* One edge of a face: face << 2 | edge. It runs from corner `edge` to the next one. */
typedef uint64_t border_key;

/* A part of an edge: the whole of it, or, of a quad beside an n-gon, one of two halves. */
struct border_part {
    border_key owner; /* if it is another edge, that edge runs the other way */
    double from, to;  /* on this edge, from 0 to 1 */
};

/* Finds the parts of an edge, in its direction: one or two. Pure, any thread. */
unsigned border_parts(const struct limit_tables *tables, uint32_t face, unsigned edge,
                      struct border_part parts[2]);

/* The vertices: number[face << 2 | corner] is that of the corner's vertex, from 0 to n - 1, in the order of each
 * vertex's lowest corner. */
struct border_vertices {
    uint32_t *number;
    size_t n;
};

/* False with ERROR_SERVER when memory is short. One thread. */
bool border_vertices_find(struct border_vertices *vertices, const struct limit_tables *tables,
                          struct error *error);
void border_vertices_finish(struct border_vertices *vertices);

#endif
