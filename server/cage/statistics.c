#include "server/cage/statistics.h"

#include <stdlib.h>

#include "server/cage/edges.h"
#include "server/cage/joints.h"

enum { ON_BOUNDARY = 1, NON_MANIFOLD = 2, HAS_FAN = 4 };

struct edges {
    const struct cage *cage;
    struct cage_statistics *statistics;
    struct cage_edges by_vertex;
    /* [corners]: sharpness of an edge, stored at its first half-edge; NULL: no creases. */
    float *sharpness;
    uint32_t *valence;  /* [n_vertices]: faces around it */
    uint8_t *flags;     /* [n_vertices] */
    uint32_t *fan_link; /* [corners]: union-find of the corners that edges join around a vertex */
};

static void edges_finish(struct edges *edges)
{
    cage_edges_finish(&edges->by_vertex);
    free(edges->sharpness);
    free(edges->valence);
    free(edges->flags);
    free(edges->fan_link);
}

static bool edges_init(struct edges *edges, const struct cage *cage,
                       struct cage_statistics *statistics, struct error *error)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    *edges = (struct edges){
        .cage = cage,
        .statistics = statistics,
        .sharpness = cage->n_creases ? calloc(n_corners + 1, sizeof *edges->sharpness) : NULL,
        .valence = calloc(cage->n_vertices + 1, sizeof *edges->valence),
        .flags = calloc(cage->n_vertices + 1, 1),
        .fan_link = calloc(n_corners + 1, sizeof *edges->fan_link),
    };
    if (edges->valence && edges->flags && edges->fan_link &&
        (edges->sharpness || !cage->n_creases) && cage_edges_init(&edges->by_vertex, cage))
        return true;
    edges_finish(edges);
    return error_set(error, ERROR_SERVER, "no memory to count the edges of %zu faces",
                     cage->n_faces);
}

/* --- which faces are joined */

static uint32_t fan_of(struct edges *edges, uint32_t corner)
{
    uint32_t *link = edges->fan_link;
    while (link[corner] != corner)
        corner = link[corner] = link[link[corner]]; /* path halving */
    return corner;
}

/* Two faces that traverse an edge in opposite directions are joined at both of its ends. */
static void join_faces(struct edges *edges, const struct cage_half_edge *a,
                       const struct cage_half_edge *b)
{
    edges->fan_link[fan_of(edges, a->corner)] = fan_of(edges, b->next);
    edges->fan_link[fan_of(edges, a->next)] = fan_of(edges, b->corner);
}

static void count_edge(void *context, uint32_t low, const struct cage_half_edge *half_edge,
                       size_t n)
{
    struct edges *edges = context;
    const uint32_t *face_vertex = edges->cage->face_vertex;
    uint8_t flag = 0;
    if (n == 1) {
        edges->statistics->n_boundary_edges++;
        flag = ON_BOUNDARY;
    } else if (n == 2 && face_vertex[half_edge[0].corner] != face_vertex[half_edge[1].corner]) {
        join_faces(edges, &half_edge[0], &half_edge[1]);
    } else {
        edges->statistics->n_nonmanifold_edges++;
        flag = NON_MANIFOLD;
    }
    edges->flags[low] |= flag;
    edges->flags[half_edge->high] |= flag;
}

static void count_edges(const struct cage *cage, struct edges *edges,
                        struct cage_statistics *statistics)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    for (uint32_t c = 0; c < n_corners; c++)
        edges->fan_link[c] = c;
    cage_each_edge(&edges->by_vertex, cage->n_vertices, count_edge, edges);
    for (uint32_t c = 0; c < n_corners; c++) {
        uint8_t *flags = &edges->flags[cage->face_vertex[c]];
        if (fan_of(edges, c) == c)
            *flags |= *flags & HAS_FAN ? NON_MANIFOLD : HAS_FAN;
    }
    for (size_t v = 0; v < cage->n_vertices; v++)
        statistics->n_nonmanifold_vertices += (edges->flags[v] & NON_MANIFOLD) != 0;
}

/* --- tags; of two for the same element the later one counts */

/* The first half-edge of an edge of the cage. */
static size_t find_edge(const struct edges *edges, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    size_t begin = edges->by_vertex.start[low], end = edges->by_vertex.start[low + 1];
    while (begin < end) {
        size_t middle = begin + (end - begin) / 2;
        if (edges->by_vertex.half_edge[middle].high < high)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

static void count_creases(const struct cage *cage, struct edges *edges,
                          struct cage_statistics *statistics)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    for (size_t i = 0; i < cage->n_creases; i++)
        edges->sharpness[find_edge(edges, cage->crease[i].vertex[0], cage->crease[i].vertex[1])] =
            cage->crease[i].sharpness;
    for (size_t i = 0; i < n_corners && edges->sharpness; i++) {
        bool sharp = edges->sharpness[i] >= CAGE_SHARPNESS_INFINITE;
        statistics->n_sharp_edges += sharp;
        statistics->n_semisharp_edges += edges->sharpness[i] > 0 && !sharp;
    }
}

static bool count_tags(const struct cage *cage, struct cage_statistics *statistics,
                       struct error *error)
{
    uint8_t *sharp = calloc(cage->n_vertices + 1, 1), *hole = calloc(cage->n_faces + 1, 1);
    bool ok = sharp && hole;
    for (size_t i = 0; ok && i < cage->n_corners; i++)
        sharp[cage->corner[i].vertex] = cage->corner[i].sharpness > 0;
    for (size_t i = 0; ok && i < cage->n_holes; i++)
        hole[cage->hole[i]] = 1;
    for (size_t v = 0; ok && v < cage->n_vertices; v++)
        statistics->n_sharp_vertices += sharp[v];
    for (size_t f = 0; ok && f < cage->n_faces; f++)
        statistics->n_holes += hole[f];
    free(sharp);
    free(hole);
    return ok || error_set(error, ERROR_SERVER, "no memory to count the tags of %zu faces",
                           cage->n_faces);
}

/* --- valences */

/* Fills in the table of valences; the last entry counts all that do not fit. */
static void count_valences(struct cage_statistics *statistics, uint32_t *by_valence,
                           uint32_t max_valence)
{
    for (uint32_t valence = 1; valence <= max_valence; valence++) {
        if (valence == 4 || by_valence[valence] == 0)
            continue;
        if (statistics->n_valences < CAGE_MAX_VALENCES) {
            statistics->extraordinary[statistics->n_valences].valence = valence;
            statistics->extraordinary[statistics->n_valences++].count = by_valence[valence];
        } else {
            statistics->extraordinary[CAGE_MAX_VALENCES - 1].count += by_valence[valence];
        }
    }
}

static bool count_vertices(const struct cage *cage, const struct edges *edges,
                           struct cage_statistics *statistics, struct error *error)
{
    uint32_t max_valence = 0;
    for (size_t v = 0; v < cage->n_vertices; v++)
        if (edges->valence[v] > max_valence)
            max_valence = edges->valence[v];
    uint32_t *by_valence = calloc((size_t)max_valence + 1, sizeof *by_valence);
    if (!by_valence)
        return error_set(error, ERROR_SERVER, "no memory to count %u valences", max_valence);
    for (size_t v = 0; v < cage->n_vertices; v++) {
        if (edges->flags[v] & ON_BOUNDARY)
            statistics->n_boundary_extraordinary += edges->valence[v] != 2;
        else
            by_valence[edges->valence[v]]++;
    }
    count_valences(statistics, by_valence, max_valence);
    free(by_valence);
    return true;
}

static bool count_patches(const struct cage *cage, struct cage_statistics *statistics,
                          struct error *error)
{
    struct cage_joints joints;
    if (!cage_joints_find(&joints, cage))
        return error_set(error, ERROR_SERVER, "no memory to count the edges of %zu patches",
                         cage->n_patches);
    statistics->n_patches = (uint32_t)cage->n_patches;
    statistics->n_boundary_edges = joints.n_boundary;
    statistics->n_nonmanifold_edges = joints.n_tangled + joints.n_against;
    cage_joints_finish(&joints);
    return true;
}

bool cage_statistics(const struct cage *cage, struct cage_statistics *statistics,
                     struct error *error)
{
    *statistics = (struct cage_statistics){0};
    if (cage->n_patches > 0)
        return count_patches(cage, statistics, error);
    struct edges edges;
    if (!edges_init(&edges, cage, statistics, error))
        return false;
    for (size_t face = 0; face < cage->n_faces; face++) {
        uint32_t n = cage->face_start[face + 1] - cage->face_start[face];
        statistics->n_triangles += n == 3;
        statistics->n_quads += n == 4;
        statistics->n_ngons += n > 4;
    }
    for (size_t i = 0; i < cage->face_start[cage->n_faces]; i++)
        edges.valence[cage->face_vertex[i]]++;
    count_edges(cage, &edges, statistics);
    count_creases(cage, &edges, statistics);
    bool ok =
        count_vertices(cage, &edges, statistics, error) && count_tags(cage, statistics, error);
    edges_finish(&edges);
    return ok;
}
