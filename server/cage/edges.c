#include "server/cage/edges.h"

#include <stdlib.h>

/* Calls visit for the edge that leaves every corner of the cage. */
static void each_side(const struct cage *cage, struct cage_edges *sides,
                      void (*visit)(struct cage_edges *sides, uint32_t low,
                                    struct cage_half_edge side))
{
    for (size_t face = 0; face < cage->n_faces; face++) {
        uint32_t first = cage->face_start[face], last = cage->face_start[face + 1];
        for (uint32_t i = first; i < last; i++) {
            uint32_t next = i + 1 < last ? i + 1 : first;
            uint32_t a = cage->face_vertex[i], b = cage->face_vertex[next];
            visit(sides, a < b ? a : b, (struct cage_half_edge){a < b ? b : a, i, next});
        }
    }
}

/* Counts two places ahead, so that filling leaves start[v] where v's sides begin. */
static void count_side(struct cage_edges *sides, uint32_t low, struct cage_half_edge side)
{
    (void)side;
    sides->start[low + 2]++;
}

static void fill_side(struct cage_edges *sides, uint32_t low, struct cage_half_edge side)
{
    sides->side[sides->start[low + 1]++] = side;
}

static int compare_sides(const void *a, const void *b)
{
    const struct cage_half_edge *p = a, *q = b;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return p->corner < q->corner ? -1 : p->corner > q->corner;
}

bool cage_edges_init(struct cage_edges *sides, const struct cage *cage)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    sides->start = calloc(cage->n_vertices + 2, sizeof *sides->start);
    sides->side = calloc(n_corners + 1, sizeof *sides->side);
    if (!sides->start || !sides->side) {
        cage_edges_finish(sides);
        return false;
    }
    each_side(cage, sides, count_side);
    for (size_t v = 0; v <= cage->n_vertices; v++)
        sides->start[v + 1] += sides->start[v];
    each_side(cage, sides, fill_side);
    for (size_t v = 0; v < cage->n_vertices; v++)
        if (sides->start[v + 1] - sides->start[v] > 1)
            qsort(sides->side + sides->start[v], sides->start[v + 1] - sides->start[v],
                  sizeof *sides->side, compare_sides);
    return true;
}

void cage_edges_finish(struct cage_edges *sides)
{
    free(sides->start);
    free(sides->side);
    *sides = (struct cage_edges){0};
}

void cage_each_edge(const struct cage_edges *sides, size_t n_vertices,
                    void (*visit)(void *context, uint32_t low, const struct cage_half_edge *side,
                                  size_t n),
                    void *context)
{
    const struct cage_half_edge *side = sides->side;
    for (uint32_t v = 0; v < n_vertices; v++)
        for (uint32_t first = sides->start[v], last; first < sides->start[v + 1]; first = last) {
            for (last = first + 1;
                 last < sides->start[v + 1] && side[last].high == side[first].high; last++)
                ;
            visit(context, v, side + first, last - first);
        }
}
