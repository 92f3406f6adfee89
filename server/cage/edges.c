#include "server/cage/edges.h"

#include <stdlib.h>

/* Calls visit() for the half-edge from each corner of the cage. */
static void each_half_edge(const struct cage *cage, struct cage_edges *edges,
                           void (*visit)(struct cage_edges *edges, uint32_t low,
                                         struct cage_half_edge half_edge))
{
    for (size_t face = 0; face < cage->n_faces; face++) {
        uint32_t first = cage->face_start[face], last = cage->face_start[face + 1];
        for (uint32_t i = first; i < last; i++) {
            uint32_t next = i + 1 < last ? i + 1 : first;
            uint32_t a = cage->face_vertex[i], b = cage->face_vertex[next];
            visit(edges, a < b ? a : b, (struct cage_half_edge){a < b ? b : a, i, next});
        }
    }
}

/* Counts two places ahead: after filling, start[v] is where v's half-edges begin. */
static void count_half_edge(struct cage_edges *edges, uint32_t low, struct cage_half_edge half_edge)
{
    (void)half_edge;
    edges->start[low + 2]++;
}

static void fill_half_edge(struct cage_edges *edges, uint32_t low, struct cage_half_edge half_edge)
{
    edges->half_edge[edges->start[low + 1]++] = half_edge;
}

static int compare_half_edges(const void *a, const void *b)
{
    const struct cage_half_edge *p = a, *q = b;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return p->corner < q->corner ? -1 : p->corner > q->corner;
}

bool cage_edges_init(struct cage_edges *edges, const struct cage *cage)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    edges->start = calloc(cage->n_vertices + 2, sizeof *edges->start);
    edges->half_edge = calloc(n_corners + 1, sizeof *edges->half_edge);
    if (!edges->start || !edges->half_edge) {
        cage_edges_finish(edges);
        return false;
    }
    each_half_edge(cage, edges, count_half_edge);
    for (size_t v = 0; v <= cage->n_vertices; v++)
        edges->start[v + 1] += edges->start[v];
    each_half_edge(cage, edges, fill_half_edge);
    for (size_t v = 0; v < cage->n_vertices; v++)
        if (edges->start[v + 1] - edges->start[v] > 1)
            qsort(edges->half_edge + edges->start[v], edges->start[v + 1] - edges->start[v],
                  sizeof *edges->half_edge, compare_half_edges);
    return true;
}

void cage_edges_finish(struct cage_edges *edges)
{
    free(edges->start);
    free(edges->half_edge);
    *edges = (struct cage_edges){0};
}

void cage_each_edge(const struct cage_edges *edges, size_t n_vertices,
                    void (*visit)(void *context, uint32_t low,
                                  const struct cage_half_edge *half_edge, size_t n),
                    void *context)
{
    const struct cage_half_edge *half_edge = edges->half_edge;
    for (uint32_t v = 0; v < n_vertices; v++)
        for (uint32_t first = edges->start[v], last; first < edges->start[v + 1]; first = last) {
            for (last = first + 1;
                 last < edges->start[v + 1] && half_edge[last].high == half_edge[first].high;
                 last++)
                ;
            visit(context, v, half_edge + first, last - first);
        }
}
