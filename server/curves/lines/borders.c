#include "server/curves/lines/borders.h"

#include <stdlib.h>

static bool is_half(const struct limit_node *face, unsigned edge)
{
    return face->ngon_size && (edge == 0 || edge == 3);
}

static bool is_sharp(const struct limit_node *face, unsigned edge)
{
    return (face->borders >> (4 * edge) & 15) == LIMIT_BORDER_SHARP;
}

/* Is `key` an edge that in turn has `back` across it? */
static bool leads_back(const struct limit_tables *tables, uint32_t key, uint32_t back)
{
    return key >> 2 < tables->n_faces && tables->adjacency[key >> 2].across[key & 3] == back &&
           !is_sharp(&tables->nodes[key >> 2], key & 3);
}

unsigned border_parts(const struct limit_tables *tables, uint32_t face, unsigned edge,
                      struct border_part parts[2])
{
    const struct limit_node *node = &tables->nodes[face];
    uint32_t self = face << 2 | edge, other = tables->adjacency[face].across[edge];
    parts[0] = (struct border_part){self, 0, 1};
    if (other == LIMIT_NO_FACE || other >> 2 >= tables->n_faces || is_sharp(node, edge))
        return 1;
    const struct limit_node *beyond = &tables->nodes[other >> 2];
    bool beyond_half = is_half(beyond, other & 3);
    if (is_half(node, edge) || !beyond_half) {
        bool same_size = is_half(node, edge) == beyond_half;
        if (same_size && other < self && leads_back(tables, other, self))
            parts[0].owner = other;
        return 1;
    }
    /* Two faces of an n-gon: `other` is at the end of this edge, the next one at its start. */
    uint32_t corner = beyond->ngon_corner, next = corner + 1u == beyond->ngon_size ? 0 : corner + 1;
    uint32_t start = ((other >> 2) - corner + next) << 2 | 3;
    if (!leads_back(tables, other, self) || !leads_back(tables, start, self))
        return 1;
    parts[0] = (struct border_part){start, 0, 0.5};
    parts[1] = (struct border_part){other, 0.5, 1};
    return 2;
}

static uint32_t root_of(uint32_t *parent, uint32_t corner)
{
    while (parent[corner] != corner) {
        parent[corner] = parent[parent[corner]];
        corner = parent[corner];
    }
    return corner;
}

/* The lower one becomes the root. */
static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = root_of(parent, a);
    b = root_of(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

static uint32_t corner_of(border_key edge, unsigned end)
{
    return (uint32_t)(edge >> 2) << 2 | (((uint32_t)edge + end) & 3);
}

static void join_along(const struct limit_tables *tables, uint32_t *parent, uint32_t face,
                       unsigned edge)
{
    struct border_part parts[2];
    unsigned n = border_parts(tables, face, edge, parts);
    border_key self = face << 2 | edge;
    if (parts[0].owner == self)
        return;
    join(parent, corner_of(self, 0), corner_of(parts[0].owner, 1));
    if (n == 2)
        join(parent, corner_of(parts[0].owner, 0), corner_of(parts[1].owner, 1));
    join(parent, corner_of(self, 1), corner_of(parts[n - 1].owner, 0));
}

bool border_vertices_find(struct border_vertices *vertices, const struct limit_tables *tables,
                          struct error *error)
{
    size_t n = 4 * tables->n_faces;
    *vertices = (struct border_vertices){.number = malloc((n ? n : 1) * sizeof(uint32_t))};
    uint32_t *number = vertices->number;
    if (!number)
        return error_set(error, ERROR_SERVER, "out of memory for %zu corners", n);
    for (size_t c = 0; c < n; c++)
        number[c] = (uint32_t)c;
    for (uint32_t face = 0; face < tables->n_faces; face++)
        for (unsigned edge = 0; edge < 4; edge++)
            join_along(tables, number, face, edge);
    /* A root is below all other corners of its vertex, so that its number is known first. */
    for (size_t c = 0; c < n; c++)
        number[c] = root_of(number, (uint32_t)c);
    for (size_t c = 0; c < n; c++)
        number[c] = number[c] == c ? (uint32_t)vertices->n++ : number[number[c]];
    return true;
}

void border_vertices_finish(struct border_vertices *vertices)
{
    free(vertices->number);
    *vertices = (struct border_vertices){0};
}
