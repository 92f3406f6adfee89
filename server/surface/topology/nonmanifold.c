#include "server/surface/topology/nonmanifold.h"

#include <stdlib.h>

/* One sheet at a vertex, given by the first corner of its sector. */
struct sheet {
    uint32_t vertex, first;
};

struct sheet_list {
    struct sheet *sheet;
    size_t n;
};

/* The sharp edges of one vertex, during the count. */
struct sharp_edges {
    float *semisharp; /* room for the edges of any vertex */
    uint32_t n_semisharp, n_infinite;
    uint32_t end[2], n_ends;
};

static bool is_wanted(const struct topology *t, uint32_t corner)
{
    uint8_t flags = t->vertex_flags[corner_vertex(t, corner)];
    bool has_creases = t->cage->chaikin && flags & VERTEX_CREASED;
    return flags & VERTEX_NON_MANIFOLD && (!(flags & VERTEX_SHARP) || has_creases);
}

static int compare_sheets(const void *a, const void *b)
{
    const struct sheet *p = a, *q = b;
    if (p->vertex != q->vertex)
        return p->vertex < q->vertex ? -1 : 1;
    return p->first < q->first ? -1 : p->first > q->first;
}

/* Lists every sheet once, sorted by vertex. Each sector is traversed once, because a vertex may
 * have any number of faces. */
static bool list_sheets(const struct topology *t, size_t n_wanted, struct sheet_list *list)
{
    uint32_t n_corners = t->cage->face_start[t->cage->n_faces];
    uint8_t *seen = calloc(n_corners, 1);
    *list = (struct sheet_list){malloc(n_wanted * sizeof *list->sheet), 0};
    if (!seen || !list->sheet) {
        free(seen);
        free(list->sheet);
        return false;
    }
    for (uint32_t c = 0; c < n_corners; c++) {
        if (seen[c] || !is_wanted(t, c))
            continue;
        struct sector sector = topology_sector(t, c);
        list->sheet[list->n++] = (struct sheet){corner_vertex(t, c), sector.first};
        for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at))
            seen[at] = 1;
    }
    free(seen);
    qsort(list->sheet, list->n, sizeof *list->sheet, compare_sheets);
    return true;
}

static void add_end(struct sharp_edges *edges, uint32_t vertex)
{
    for (uint32_t k = 0; k < edges->n_ends; k++)
        if (edges->end[k] == vertex)
            return;
    if (edges->n_ends < 2)
        edges->end[edges->n_ends++] = vertex;
}

static void add_sheet(const struct topology *t, uint32_t first, struct sharp_edges *edges)
{
    struct sector sector = topology_sector(t, first);
    for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at)) {
        float sharpness = edge_sharpness(t, at);
        if (t->twin[at] == CORNER_NONE)
            add_end(edges, corner_vertex(t, corner_next(t, at)));
        else if (sharpness >= CAGE_SHARPNESS_INFINITE)
            edges->n_infinite++;
        else if (sharpness > 0)
            edges->semisharp[edges->n_semisharp++] = sharpness;
        if (corner_ccw(t, at) == CORNER_NONE)
            add_end(edges, corner_vertex(t, corner_prev(t, at)));
    }
}

static bool add_level(struct topology *t, size_t *capacity, struct vertex_creases level)
{
    if (t->n_vertex_creases == *capacity) {
        size_t larger = *capacity ? 2 * *capacity : 64;
        struct vertex_creases *grown = realloc(t->vertex_creases, larger * sizeof *grown);
        if (!grown)
            return false;
        t->vertex_creases = grown;
        *capacity = larger;
    }
    t->vertex_creases[t->n_vertex_creases++] = level;
    return true;
}

/* One step of subdivision: edges that stay semi-sharp move to the front. */
static void wear_off(struct sharp_edges *edges, bool chaikin, const struct sharpness_sum *sum)
{
    uint32_t left = 0;
    for (uint32_t k = 0; k < edges->n_semisharp; k++) {
        float sharpness = edges->semisharp[k];
        float child =
            chaikin ? sharpness_child_chaikin(sharpness, sum) : sharpness_child(sharpness);
        if (child > 0)
            edges->semisharp[left++] = child;
    }
    edges->n_semisharp = left;
}

static bool add_levels(struct topology *t, size_t *capacity, struct sharp_edges *edges)
{
    for (bool is_last = false; !is_last;) {
        is_last = edges->n_semisharp == 0;
        struct vertex_creases level = {.n_sharp =
                                           edges->n_ends + edges->n_infinite + edges->n_semisharp};
        for (uint32_t k = 0; k < edges->n_semisharp; k++)
            sharpness_add(&level.semisharp, edges->semisharp[k]);
        wear_off(edges, t->cage->chaikin, &level.semisharp);
        if (!add_level(t, capacity, level))
            return false;
    }
    return true;
}

static bool add_vertices(struct topology *t, const struct sheet_list *list, float *room)
{
    size_t capacity = 0;
    for (size_t first = 0, last; first < list->n; first = last) {
        uint32_t v = list->sheet[first].vertex;
        struct sharp_edges edges = {.semisharp = room, .end = {v, v}};
        for (last = first; last < list->n && list->sheet[last].vertex == v; last++)
            add_sheet(t, list->sheet[last].first, &edges);
        t->nonmanifold[t->n_nonmanifold++] = (struct nonmanifold_vertex){
            v, {edges.end[0], edges.end[1]}, (uint32_t)t->n_vertex_creases};
        if (!add_levels(t, &capacity, &edges))
            return false;
    }
    return true;
}

bool nonmanifold_find(struct topology *t)
{
    uint32_t n_corners = t->cage->face_start[t->cage->n_faces];
    size_t n_wanted = 0;
    struct sheet_list list;
    for (uint32_t c = 0; c < n_corners; c++)
        n_wanted += is_wanted(t, c);
    if (!n_wanted)
        return true;
    if (!list_sheets(t, n_wanted, &list))
        return false;
    float *room = malloc(n_wanted * sizeof *room);
    t->nonmanifold = malloc(list.n * sizeof *t->nonmanifold);
    bool ok = room && t->nonmanifold && add_vertices(t, &list, room);
    free(room);
    free(list.sheet);
    return ok;
}

static int compare_vertex(const void *key, const void *element)
{
    uint32_t vertex = *(const uint32_t *)key,
             other = ((const struct nonmanifold_vertex *)element)->vertex;
    return vertex < other ? -1 : vertex > other;
}

const struct nonmanifold_vertex *nonmanifold_at(const struct topology *t, uint32_t corner)
{
    uint32_t vertex = corner_vertex(t, corner);
    if (!t->n_nonmanifold || !is_wanted(t, corner))
        return NULL;
    return bsearch(&vertex, t->nonmanifold, t->n_nonmanifold, sizeof *t->nonmanifold,
                   compare_vertex);
}
