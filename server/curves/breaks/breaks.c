#include "server/curves/breaks/breaks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/curves/breaks/joints.h"
#include "server/curves/computation.h"
#include "server/curves/breaks/measure.h"

enum { PHASE_BORDERS, PHASE_EDGES, PHASE_VERTICES, PHASE_SORTING };
static const char *const STAGES[] = {"borders", "edges", "vertices", "sorting", NULL};

/* Items of one slice: each takes about a millisecond; a border takes much less. */
enum { SLICE_BORDERS = 128, SLICE_EDGES = 4, SLICE_VERTICES = 16 };

struct breaks {
    struct computation base;
    struct break_setup setup;
    struct surface_edges list;
    unsigned phase;
    struct break_border *borders; /* [list.n_borders] */
    struct surface_edge *joints;
    size_t n_joints;
    struct break_edge *edges;      /* [list.n_creases + n_joints]; length 0: not measured */
    struct break_vertex *vertices; /* [list.n_sectors]; n_faces 0: not measured */
    struct breaks_found result;
};

static bool no_memory(struct error *error)
{
    return error_set(error, ERROR_SERVER, "no memory to find breaks: try again later");
}

static size_t slices_of(size_t n, size_t items)
{
    return (n + items - 1) / items;
}

/* The edges and joints that are measured, in one order. */
static const struct surface_edge *edge_of(const struct breaks *breaks, size_t i, uint8_t *kind)
{
    if (i >= breaks->list.n_creases) {
        *kind = BREAK_JOINT;
        return &breaks->joints[i - breaks->list.n_creases];
    }
    const struct surface_edge *edge = &breaks->list.creases[i];
    *kind = edge->is_bend                        ? BREAK_JOINT
            : edge->levels == LIMIT_BORDER_SHARP ? BREAK_CREASE
                                                 : BREAK_SEMISHARP;
    return edge;
}

static size_t n_edges_of(const struct breaks *breaks)
{
    return breaks->list.n_creases + breaks->n_joints;
}

/* --- what is left out, and the order */

static int by_severity(const void *a, const void *b)
{
    const struct break_sorted *p = a, *q = b;
    if (p->severity != q->severity)
        return p->severity > q->severity ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

/* Sorts the edges that were measured: the worst first. */
static bool sort_edges(struct breaks *breaks, struct error *error)
{
    const size_t n = n_edges_of(breaks);
    struct break_sorted *order = malloc((n + 1) * sizeof *order);
    struct break_edge *sorted = malloc((n + 1) * sizeof *sorted);
    size_t kept = 0;
    if (!order || !sorted) {
        free(order);
        free(sorted);
        return no_memory(error);
    }
    for (size_t i = 0; i < n; i++)
        if (breaks->edges[i].length > 0)
            order[kept++] =
                (struct break_sorted){breaks_severity(&breaks->setup, &breaks->edges[i]), i};
    qsort(order, kept, sizeof *order, by_severity);
    for (size_t i = 0; i < kept; i++)
        sorted[i] = breaks->edges[order[i].index];
    free(order);
    free(breaks->edges);
    breaks->edges = sorted;
    breaks->result.edges = sorted;
    breaks->result.n_edges = kept;
    return true;
}

static void count(struct breaks *breaks)
{
    struct break_counts *counts = &breaks->result.counts;
    size_t n = 0;
    *counts = (struct break_counts){.borders = (uint32_t)breaks->list.n_borders};
    for (size_t i = 0; i < breaks->list.n_borders; i++)
        counts->borders_length += breaks->borders[i].length;
    for (size_t i = 0; i < breaks->result.n_edges; i++) {
        const struct break_edge *edge = &breaks->result.edges[i];
        counts->creases += edge->kind == BREAK_CREASE;
        counts->semisharp += edge->kind == BREAK_SEMISHARP;
        counts->joints += edge->kind == BREAK_JOINT;
        counts->edges_out += edge->over != 0;
        counts->creases_length += edge->kind == BREAK_CREASE ? edge->length : 0;
        counts->out_length += edge->out_length;
    }
    for (size_t i = 0; i < breaks->list.n_sectors; i++)
        if (breaks->vertices[i].n_faces > 0)
            breaks->vertices[n++] = breaks->vertices[i];
    breaks->result.vertices = breaks->vertices;
    breaks->result.n_vertices = n;
}

/* --- phases */

static bool begin_borders(struct breaks *breaks, size_t *n_slices, struct error *error)
{
    if (!surface_edges_list(&breaks->list, breaks->setup.tables, error))
        return false;
    breaks->borders = malloc((breaks->list.n_borders + 1) * sizeof *breaks->borders);
    *n_slices = slices_of(breaks->list.n_borders, SLICE_BORDERS);
    return breaks->borders || no_memory(error);
}

static bool begin_edges(struct breaks *breaks, size_t *n_slices, struct error *error)
{
    const struct joint_distances distances =
        breaks_joint_distances(breaks->setup.limits.gap, breaks_diagonal(breaks->setup.tables));
    if (!breaks_find_joints(breaks->borders, breaks->list.n_borders, distances, &breaks->joints,
                            &breaks->n_joints))
        return no_memory(error);
    const size_t n = n_edges_of(breaks);
    breaks->edges = calloc(n + 1, sizeof *breaks->edges);
    *n_slices = slices_of(n, SLICE_EDGES);
    return breaks->edges || no_memory(error);
}

static bool begin_vertices(struct breaks *breaks, size_t *n_slices, struct error *error)
{
    const size_t n = breaks->list.n_sectors;
    breaks->vertices = calloc(n + 1, sizeof *breaks->vertices);
    *n_slices = slices_of(n, SLICE_VERTICES);
    return breaks->vertices || no_memory(error);
}

static bool begin(struct computation *computation, unsigned phase, size_t *n_slices,
                  struct error *error)
{
    struct breaks *breaks = (struct breaks *)computation;
    *n_slices = 0;
    breaks->phase = phase;
    switch (phase) {
    case PHASE_BORDERS:
        return begin_borders(breaks, n_slices, error);
    case PHASE_EDGES:
        return begin_edges(breaks, n_slices, error);
    case PHASE_VERTICES:
        return begin_vertices(breaks, n_slices, error);
    default:
        if (!sort_edges(breaks, error))
            return false;
        count(breaks);
        return true;
    }
}

static void measure_border(struct breaks *breaks, size_t i)
{
    struct break_border *border = &breaks->borders[i];
    border->of = breaks->list.borders[i];
    breaks_measure_border(breaks->setup.tables, border);
}

static void measure_edge(struct breaks *breaks, size_t i)
{
    uint8_t kind;
    const struct surface_edge *edge = edge_of(breaks, i, &kind);
    if (!breaks_measure_edge(&breaks->setup, edge, kind, &breaks->edges[i]))
        breaks->edges[i].length = 0;
}

static void measure_vertex(struct breaks *breaks, size_t i)
{
    if (!breaks_measure_sector(breaks->setup.tables, &breaks->list.sectors[i],
                               &breaks->vertices[i]))
        breaks->vertices[i].n_faces = 0;
}

static void slice(struct computation *computation, size_t index)
{
    struct breaks *breaks = (struct breaks *)computation;
    const struct {
        size_t items, n;
        void (*measure)(struct breaks *breaks, size_t i);
    } phases[] = {
        [PHASE_BORDERS] = {SLICE_BORDERS, breaks->list.n_borders, measure_border},
        [PHASE_EDGES] = {SLICE_EDGES, n_edges_of(breaks), measure_edge},
        [PHASE_VERTICES] = {SLICE_VERTICES, breaks->list.n_sectors, measure_vertex},
    };
    const size_t items = phases[breaks->phase].items, n = phases[breaks->phase].n;
    const size_t first = index * items, last = n - first < items ? n : first + items;
    for (size_t i = first; i < last && !computation_is_cancelled(computation); i++)
        phases[breaks->phase].measure(breaks, i);
}

static void destroy(struct computation *computation)
{
    struct breaks *breaks = (struct breaks *)computation;
    surface_edges_finish(&breaks->list);
    free(breaks->borders);
    free(breaks->joints);
    free(breaks->edges);
    free(breaks->vertices);
    free(breaks);
}

static const struct computation_kind KIND = {STAGES, begin, slice, destroy};

double breaks_diagonal(const struct limit_tables *tables)
{
    double diagonal = 0;
    for (int i = 0; i < 3; i++)
        diagonal = hypot(diagonal, tables->box_max[i] - tables->box_min[i]);
    return diagonal;
}

uint64_t breaks_bytes(const struct limit_tables *tables)
{
    const struct surface_edges_room room = surface_edges_room(tables);
    const uint64_t joints = breaks_most_joints(room.borders);
    const uint64_t edges = room.creases + joints;
    return sizeof(struct breaks) + room.bytes + edges * BREAK_EDGE_BYTES +
           room.sectors * (uint64_t)BREAK_VERTEX_BYTES +
           edges * (2 * sizeof(struct break_edge) + sizeof(struct break_sorted)) +
           joints * sizeof(struct surface_edge) + breaks_joints_bytes(room.borders) +
           (uint64_t)room.borders * sizeof(struct break_border) +
           (uint64_t)room.sectors * sizeof(struct break_vertex) + 4096;
}

struct computation *breaks_create(const struct limit_tables *tables,
                                  const struct break_lines *lines,
                                  const struct break_limits *limits, struct error *error)
{
    struct breaks *breaks = calloc(1, sizeof *breaks);
    if (!breaks) {
        no_memory(error);
        return NULL;
    }
    breaks->base.kind = &KIND;
    breaks->setup.tables = tables;
    breaks->setup.limits = *limits;
    breaks->setup.n_lights = lines->n_lights;
    for (uint32_t i = 0; i < lines->n_lights; i++)
        line_map_init(&breaks->setup.lights[i], lines->lines, &lines->lights[i]);
    return &breaks->base;
}

struct breaks_found breaks_result(const struct computation *computation)
{
    return ((const struct breaks *)computation)->result;
}
