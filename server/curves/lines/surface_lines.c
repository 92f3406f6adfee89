#include "server/curves/lines/surface_lines.h"

#include <stdlib.h>
#include <string.h>

#include "server/curves/lines/regions.h"
#include "server/surface/evaluate.h"

enum { VERTICES, BORDERS, FACES, JOIN };
/* Faces of a slice: a slice of FACES takes a few milliseconds. */
enum { FACES_OF_SLICE = 4, FACES_OF_LIGHT_SLICE = 64 };

/* What a slice has found. */
struct part {
    struct root_list roots; /* BORDERS */
    size_t n_roots[4 * FACES_OF_LIGHT_SLICE];
};

struct surface_lines {
    struct computation base;
    const struct limit_tables *tables;
    struct line_set *set; /* owned */
    double tolerance;
    size_t most_bytes;
    atomic_size_t bytes;
    atomic_bool is_short, is_over; /* memory was short; more than most_bytes */
    struct border_vertices vertices;
    struct line_signs *sign; /* of each vertex */
    uint32_t *lowest;        /* of each vertex: its lowest corner, face << 2 | corner */
    uint8_t *levels;         /* of each node */
    struct part *parts;      /* of BORDERS */
    size_t n_parts;
    size_t *first; /* of each border: its first root */
    struct side_root *root;
    struct traced *traced; /* of each slice of FACES */
    size_t n_traced;
    atomic_size_t n_cells, n_deepest;
    struct curve_set curves;
    struct traced_mark *marks;
    size_t n_marks;
};

static size_t n_slices_of(const struct surface_lines *lines, size_t faces)
{
    return (lines->tables->n_faces + faces - 1) / faces;
}

static void charge(struct surface_lines *lines, size_t bytes)
{
    if (atomic_fetch_add(&lines->bytes, bytes) + bytes > lines->most_bytes)
        lines->is_over = true;
}

/* Allocates n members, cleared; counts them. NULL when memory is short. */
static void *take(struct surface_lines *lines, size_t n, size_t size)
{
    charge(lines, n * size);
    return lines->is_over ? NULL : calloc(n ? n : 1, size);
}

static bool has_failed(const struct surface_lines *lines, struct error *error)
{
    if (lines->is_over)
        return !error_set(error, ERROR_REQUEST,
                          "the curves take more than %zu MB of memory: ask for fewer lines, or "
                          "for a larger tolerance",
                          lines->most_bytes >> 20);
    return lines->is_short && !error_set(error, ERROR_SERVER, "out of memory for lines");
}

static bool out_of_memory(const struct surface_lines *lines, struct error *error)
{
    return has_failed(lines, error) ? false
                                    : error_set(error, ERROR_SERVER, "out of memory for lines");
}

static bool begin_vertices(struct surface_lines *lines, size_t *n_slices, struct error *error)
{
    size_t n = 4 * lines->tables->n_faces;
    charge(lines, n * sizeof *lines->vertices.number);
    if (!border_vertices_find(&lines->vertices, lines->tables, error))
        return false;
    lines->sign = take(lines, lines->vertices.n, sizeof *lines->sign);
    lines->lowest = take(lines, lines->vertices.n, sizeof *lines->lowest);
    lines->levels = take(lines, lines->tables->n_nodes, 1);
    if (!lines->sign || !lines->lowest || !lines->levels)
        return out_of_memory(lines, error);
    for (size_t c = n; c > 0; c--)
        lines->lowest[lines->vertices.number[c - 1]] = (uint32_t)(c - 1);
    *n_slices = n_slices_of(lines, FACES_OF_LIGHT_SLICE);
    return true;
}

/* The signs at the vertices whose lowest corner is one of the face's, and the face's levels. */
static void slice_vertices(struct surface_lines *lines, uint32_t face)
{
    set_levels_of_face(lines->tables, face, lines->tolerance, lines->levels);
    for (unsigned corner = 0; corner < 4; corner++) {
        uint32_t self = face << 2 | corner, vertex = lines->vertices.number[self];
        const struct limit_place place = {.node = face, .corner = corner, .a = 0, .b = 0};
        struct limit_point at;
        if (lines->lowest[vertex] == self && limit_evaluate_at(lines->tables, &place, &at))
            line_set_signs(lines->set, at.s, at.n, &lines->sign[vertex]);
    }
}

static bool begin_borders(struct surface_lines *lines, size_t *n_slices, struct error *error)
{
    *n_slices = lines->n_parts = n_slices_of(lines, FACES_OF_LIGHT_SLICE);
    lines->parts = take(lines, lines->n_parts, sizeof *lines->parts);
    lines->first = take(lines, 4 * lines->tables->n_faces + 1, sizeof *lines->first);
    return lines->parts && lines->first ? true : out_of_memory(lines, error);
}

static struct sides_work work_of(struct surface_lines *lines)
{
    return (struct sides_work){.tables = lines->tables,
                               .set = lines->set,
                               .levels = lines->levels,
                               .computation = &lines->base};
}

static void slice_borders(struct surface_lines *lines, struct part *part, struct sides_work *work,
                          uint32_t face, size_t n_roots[4])
{
    for (unsigned edge = 0; edge < 4; edge++) {
        struct border_part parts[2];
        border_parts(lines->tables, face, edge, parts);
        if (parts[0].owner != (border_key)(face << 2 | edge))
            continue;
        size_t before = part->roots.n;
        const uint32_t *number = lines->vertices.number;
        struct line_signs signs = lines->sign[number[face << 2 | edge]];
        struct root_list roots = {0};
        sides_find(work, face, edge, &signs, &lines->sign[number[face << 2 | ((edge + 1) & 3)]],
                   &roots);
        for (size_t k = 0; k < roots.n; k++)
            root_list_add(work, &part->roots, roots.root[k]);
        root_list_finish(&roots);
        n_roots[edge] = part->roots.n - before;
    }
}

/* Puts the roots of all slices into one array. */
static bool begin_faces(struct surface_lines *lines, size_t *n_slices, struct error *error)
{
    size_t n = 0;
    for (size_t k = 0; k < lines->n_parts; k++)
        n += lines->parts[k].roots.n;
    lines->root = take(lines, n, sizeof *lines->root);
    *n_slices = lines->n_traced = n_slices_of(lines, FACES_OF_SLICE);
    lines->traced = take(lines, lines->n_traced, sizeof *lines->traced);
    if (!lines->root || !lines->traced)
        return out_of_memory(lines, error);
    size_t at = 0, n_borders = 4 * lines->tables->n_faces;
    for (size_t k = 0; k < lines->n_parts; k++) {
        const struct part *part = &lines->parts[k];
        if (part->roots.n)
            memcpy(lines->root + at, part->roots.root, part->roots.n * sizeof *lines->root);
        for (size_t i = 0; i < 4 * FACES_OF_LIGHT_SLICE; i++) {
            size_t border = 4 * FACES_OF_LIGHT_SLICE * k + i;
            if (border < n_borders)
                lines->first[border] = at;
            at += part->n_roots[i];
        }
    }
    lines->first[n_borders] = at;
    return true;
}

static void slice_faces(struct surface_lines *lines, size_t slice)
{
    size_t used = lines->bytes, room = lines->most_bytes > used ? lines->most_bytes - used : 0;
    struct tracer tracer = {.work = work_of(lines),
                            .squares = trace_squares_take(),
                            .tolerance = lines->tolerance,
                            .most_points = room / sizeof(struct traced_point)};
    const struct border_roots borders = {&lines->vertices, lines->sign, lines->first, lines->root};
    size_t first = slice * FACES_OF_SLICE, last = first + FACES_OF_SLICE;
    if (!tracer.squares) {
        lines->is_short = true;
        return;
    }
    for (size_t face = first; face < last && face < lines->tables->n_faces; face++)
        if (!lines->base.cancelled && !lines->is_over)
            trace_face(&tracer, (uint32_t)face, &borders);
    free(tracer.squares);
    if (tracer.is_over)
        lines->is_over = true;
    else if (tracer.work.failed)
        lines->is_short = true;
    charge(lines, traced_bytes(&tracer.out));
    lines->traced[slice] = tracer.out;
    lines->n_cells += tracer.n_cells;
    size_t deepest = lines->n_deepest;
    while (tracer.n_deepest > deepest &&
           !atomic_compare_exchange_weak(&lines->n_deepest, &deepest, tracer.n_deepest))
        ;
}

static bool begin_join(struct surface_lines *lines, size_t *n_slices, struct error *error)
{
    size_t n = 0, points = 0, arcs = 0;
    for (size_t k = 0; k < lines->n_traced; k++) {
        n += lines->traced[k].n_marks;
        points += lines->traced[k].n_points;
        arcs += lines->traced[k].n_arcs;
    }
    lines->marks = take(lines, n, sizeof *lines->marks);
    /* What curve_set_make() takes. */
    charge(lines, points * (sizeof(struct traced_point) + sizeof(double)) +
                      arcs * (sizeof(struct curve) + 100));
    if (!lines->marks || lines->is_over)
        return out_of_memory(lines, error);
    for (size_t k = 0; k < lines->n_traced; k++)
        for (size_t i = 0; i < lines->traced[k].n_marks; i++)
            lines->marks[lines->n_marks++] = lines->traced[k].mark[i];
    *n_slices = 0;
    return curve_set_make(&lines->curves, lines->traced, lines->n_traced, error);
}

static bool begin(struct computation *computation, unsigned phase, size_t *n_slices,
                  struct error *error)
{
    struct surface_lines *lines = (struct surface_lines *)computation;
    if (has_failed(lines, error))
        return false;
    switch (phase) {
    case VERTICES:
        return begin_vertices(lines, n_slices, error);
    case BORDERS:
        return begin_borders(lines, n_slices, error);
    case FACES:
        return begin_faces(lines, n_slices, error);
    default:
        return begin_join(lines, n_slices, error);
    }
}

static void slice_light(struct surface_lines *lines, unsigned phase, size_t slice)
{
    struct part *part = phase == BORDERS ? &lines->parts[slice] : NULL;
    struct sides_work work = work_of(lines);
    size_t first = slice * FACES_OF_LIGHT_SLICE, last = first + FACES_OF_LIGHT_SLICE;
    for (size_t face = first; face < last && face < lines->tables->n_faces; face++) {
        if (lines->base.cancelled)
            break;
        if (part)
            slice_borders(lines, part, &work, (uint32_t)face, part->n_roots + 4 * (face - first));
        else
            slice_vertices(lines, (uint32_t)face);
    }
    if (part && work.failed)
        lines->is_short = true;
    if (part)
        charge(lines, part->roots.room * sizeof *part->roots.root);
}

static void slice(struct computation *computation, size_t index)
{
    struct surface_lines *lines = (struct surface_lines *)computation;
    /* The phase follows from what begin() has prepared. */
    if (lines->traced)
        slice_faces(lines, index);
    else
        slice_light(lines, lines->parts ? BORDERS : VERTICES, index);
}

static void destroy(struct computation *computation)
{
    struct surface_lines *lines = (struct surface_lines *)computation;
    for (size_t k = 0; lines->traced && k < lines->n_traced; k++)
        traced_finish(&lines->traced[k]);
    for (size_t k = 0; lines->parts && k < lines->n_parts; k++)
        root_list_finish(&lines->parts[k].roots);
    curve_set_finish(&lines->curves);
    border_vertices_finish(&lines->vertices);
    free(lines->sign);
    free(lines->lowest);
    free(lines->levels);
    free(lines->parts);
    free(lines->first);
    free(lines->root);
    free(lines->traced);
    free(lines->marks);
    free(lines->set);
    free(lines);
}

struct surface_lines *surface_lines_create(const struct limit_tables *tables,
                                           const struct line_set *set, double tolerance,
                                           size_t most_bytes, struct error *error)
{
    static const char *const STAGES[] = {"vertices", "borders", "faces", "curves", NULL};
    static const struct computation_kind KIND = {STAGES, begin, slice, destroy};
    struct surface_lines *lines = calloc(1, sizeof *lines);
    struct line_set *copy = malloc(sizeof *copy);
    if (!lines || !copy) {
        free(lines);
        free(copy);
        error_set(error, ERROR_SERVER, "out of memory for lines");
        return NULL;
    }
    *copy = *set;
    lines->base.kind = &KIND;
    lines->tables = tables;
    lines->set = copy;
    lines->tolerance = tolerance;
    lines->most_bytes = most_bytes;
    return lines;
}

struct computation *surface_lines_computation(struct surface_lines *lines)
{
    return &lines->base;
}

struct surface_lines_result surface_lines_get(const struct surface_lines *lines)
{
    return (struct surface_lines_result){.set = lines->set,
                                         .curves = &lines->curves,
                                         .marks = lines->marks,
                                         .n_marks = lines->n_marks,
                                         .n_cells = lines->n_cells,
                                         .n_deepest = lines->n_deepest};
}
