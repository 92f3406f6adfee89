#include "server/cage/survey.h"

#include <stdlib.h>

/* Edges by their lower vertex: ends[start[v] .. start[v + 1]) are the upper ends, once per face. */
struct edges {
    uint32_t *start;   /* [n_vertices + 2] */
    uint32_t *ends;    /* [corners] */
    uint32_t *valence; /* [n_vertices]: faces around it */
    bool *on_boundary; /* [n_vertices] */
};

static void edges_finish(struct edges *edges)
{
    free(edges->start);
    free(edges->ends);
    free(edges->valence);
    free(edges->on_boundary);
}

static bool edges_init(struct edges *edges, const struct cage *cage, struct error *error)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    *edges = (struct edges){
        .start = calloc(cage->n_vertices + 2, sizeof *edges->start),
        .ends = calloc(n_corners + 1, sizeof *edges->ends),
        .valence = calloc(cage->n_vertices + 1, sizeof *edges->valence),
        .on_boundary = calloc(cage->n_vertices + 1, sizeof *edges->on_boundary),
    };
    if (edges->start && edges->ends && edges->valence && edges->on_boundary)
        return true;
    edges_finish(edges);
    return error_set(error, ERROR_SERVER, "no memory to count the edges of %zu faces",
                     cage->n_faces);
}

/* Calls visit for the edge that leaves every corner of the cage. */
static void each_edge(const struct cage *cage, struct edges *edges,
                      void (*visit)(struct edges *edges, uint32_t low, uint32_t high))
{
    for (size_t face = 0; face < cage->n_faces; face++) {
        uint32_t first = cage->face_start[face], last = cage->face_start[face + 1];
        for (uint32_t i = first; i < last; i++) {
            uint32_t a = cage->face_vertex[i];
            uint32_t b = cage->face_vertex[i + 1 < last ? i + 1 : first];
            visit(edges, a < b ? a : b, a < b ? b : a);
        }
    }
}

/* Counts two places ahead, so that filling leaves start[v] where v's ends begin. */
static void count_edge(struct edges *edges, uint32_t low, uint32_t high)
{
    (void)high;
    edges->start[low + 2]++;
}

static void fill_edge(struct edges *edges, uint32_t low, uint32_t high)
{
    edges->ends[edges->start[low + 1]++] = high;
}

static int compare_u32(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static uint32_t mark_boundary(const struct cage *cage, struct edges *edges)
{
    uint32_t n_boundary = 0;
    for (size_t v = 0; v < cage->n_vertices; v++) {
        uint32_t *end = edges->ends + edges->start[v];
        size_t n = edges->start[v + 1] - edges->start[v];
        if (n > 1)
            qsort(end, n, sizeof *end, compare_u32);
        for (size_t i = 0; i < n; i++) {
            if ((i > 0 && end[i] == end[i - 1]) || (i + 1 < n && end[i] == end[i + 1]))
                continue;
            n_boundary++;
            edges->on_boundary[v] = edges->on_boundary[end[i]] = true;
        }
    }
    return n_boundary;
}

/* One count per valence; the table's end takes what does not fit. */
static void count_valences(struct cage_survey *survey, uint32_t *by_valence, uint32_t max_valence)
{
    for (uint32_t valence = 1; valence <= max_valence; valence++) {
        if (valence == 4 || by_valence[valence] == 0)
            continue;
        if (survey->n_valences < SURVEY_MAX_VALENCES) {
            survey->extraordinary[survey->n_valences].valence = valence;
            survey->extraordinary[survey->n_valences++].count = by_valence[valence];
        } else {
            survey->extraordinary[SURVEY_MAX_VALENCES - 1].count += by_valence[valence];
        }
    }
}

static bool survey_vertices(const struct cage *cage, const struct edges *edges,
                            struct cage_survey *survey, struct error *error)
{
    uint32_t max_valence = 0;
    for (size_t v = 0; v < cage->n_vertices; v++)
        if (edges->valence[v] > max_valence)
            max_valence = edges->valence[v];
    uint32_t *by_valence = calloc((size_t)max_valence + 1, sizeof *by_valence);
    if (!by_valence)
        return error_set(error, ERROR_SERVER, "no memory to count %u valences", max_valence);
    for (size_t v = 0; v < cage->n_vertices; v++) {
        if (edges->on_boundary[v])
            survey->n_boundary_extraordinary += edges->valence[v] != 2;
        else
            by_valence[edges->valence[v]]++;
    }
    count_valences(survey, by_valence, max_valence);
    free(by_valence);
    return true;
}

bool cage_survey(const struct cage *cage, struct cage_survey *survey, struct error *error)
{
    *survey = (struct cage_survey){0};
    struct edges edges;
    if (!edges_init(&edges, cage, error))
        return false;
    for (size_t face = 0; face < cage->n_faces; face++) {
        uint32_t n = cage->face_start[face + 1] - cage->face_start[face];
        survey->n_triangles += n == 3;
        survey->n_quads += n == 4;
        survey->n_ngons += n > 4;
    }
    for (size_t i = 0; i < cage->face_start[cage->n_faces]; i++)
        edges.valence[cage->face_vertex[i]]++;
    each_edge(cage, &edges, count_edge);
    for (size_t v = 0; v <= cage->n_vertices; v++)
        edges.start[v + 1] += edges.start[v];
    each_edge(cage, &edges, fill_edge);
    survey->n_boundary_edges = mark_boundary(cage, &edges);
    bool ok = survey_vertices(cage, &edges, survey, error);
    edges_finish(&edges);
    return ok;
}
