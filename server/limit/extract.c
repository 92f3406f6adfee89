#include "server/limit/extract.h"

#include <stdlib.h>

static struct vec position(const struct topology *t, uint32_t corner)
{
    const double *p = t->cage->position[corner_vertex(t, corner)];
    return (struct vec){p[0], p[1], p[2]};
}

static bool is_sharp(const struct topology *t, uint32_t corner)
{
    return t->vertex_flags[corner_vertex(t, corner)] & VERTEX_SHARP;
}

/* The ring of corner c's vertex with room for its points; fills all but positions. */
static struct ring empty_ring(const struct topology *t, uint32_t c, struct sector *sector,
                              struct arena *arena)
{
    *sector = topology_sector(t, c);
    struct ring ring = ring_take(arena, sector->n_faces, sector->closed);
    ring.at = sector->at;
    ring.sharp = is_sharp(t, c);
    return ring;
}

static struct ring vertex_ring(const struct topology *t, uint32_t c, struct arena *arena)
{
    struct sector sector;
    struct ring ring = empty_ring(t, c, &sector, arena);
    ring.centre = position(t, c);
    for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at)) {
        ring.edge[k] = position(t, corner_next(t, at));
        ring.face[k] = position(t, corner_next(t, corner_next(t, at)));
        if (!sector.closed && k + 1 == sector.n_faces)
            ring.edge[k + 1] = position(t, corner_prev(t, at));
    }
    return ring;
}

static struct ring refined_vertex_ring(const struct topology *t,
                                       const struct refined_points *points, uint32_t c,
                                       struct arena *arena)
{
    struct sector sector;
    struct ring ring = empty_ring(t, c, &sector, arena);
    ring.centre = points->vertex[corner_vertex(t, c)];
    for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at)) {
        ring.edge[k] = points->edge[at];
        ring.face[k] = points->face[t->face[at]];
        if (!sector.closed && k + 1 == sector.n_faces)
            ring.edge[k + 1] = points->edge[corner_prev(t, at)];
    }
    return ring;
}

/* Around the edge point of half-edge c, listed from its far end: end, face, start, face across. */
static struct ring refined_edge_ring(const struct topology *t, const struct refined_points *points,
                                     uint32_t c, struct arena *arena)
{
    uint32_t twin = t->twin[c];
    bool closed = twin != CORNER_NONE;
    struct ring ring = ring_take(arena, closed ? 4 : 2, closed);
    ring.centre = points->edge[c];
    ring.edge[0] = points->vertex[corner_vertex(t, corner_next(t, c))];
    ring.edge[1] = points->face[t->face[c]];
    ring.edge[2] = points->vertex[corner_vertex(t, c)];
    ring.face[0] = points->edge[corner_next(t, c)];
    ring.face[1] = points->edge[corner_prev(t, c)];
    if (closed) {
        ring.edge[3] = points->face[t->face[twin]];
        ring.face[2] = points->edge[corner_next(t, twin)];
        ring.face[3] = points->edge[corner_prev(t, twin)];
    }
    return ring;
}

/* Around the face point, listed from half-edge c; quad k lies beyond corner next(c) + k. */
static struct ring refined_face_ring(const struct topology *t, const struct refined_points *points,
                                     uint32_t c, struct arena *arena)
{
    uint32_t n = face_size(t, t->face[c]);
    struct ring ring = ring_take(arena, n, true);
    ring.centre = points->face[t->face[c]];
    for (uint32_t k = 0, at = c; k < n; k++, at = corner_next(t, at)) {
        ring.edge[k] = points->edge[at];
        ring.face[k] = points->vertex[corner_vertex(t, corner_next(t, at))];
    }
    return ring;
}

struct quad extract_quad(const struct topology *t, uint32_t c, struct arena *arena)
{
    struct quad quad;
    for (unsigned i = 0; i < 4; i++, c = corner_next(t, c))
        quad.corner[i] = vertex_ring(t, c, arena);
    return quad;
}

struct quad extract_refined_quad(const struct topology *t, const struct refined_points *points,
                                 uint32_t c, struct arena *arena)
{
    struct quad quad;
    uint32_t before = corner_prev(t, c);
    quad.corner[0] = refined_vertex_ring(t, points, c, arena);
    quad.corner[1] = refined_edge_ring(t, points, c, arena);
    quad.corner[1].at = 1;
    quad.corner[2] = refined_face_ring(t, points, before, arena);
    quad.corner[3] = refined_edge_ring(t, points, before, arena);
    return quad;
}

static void refine_face_points(const struct topology *t, struct refined_points *points)
{
    for (uint32_t f = 0; f < t->cage->n_faces; f++) {
        struct vec sum = {0, 0, 0};
        uint32_t start = t->cage->face_start[f], n = face_size(t, f);
        for (uint32_t c = start; c < start + n; c++)
            sum = vec_add(sum, position(t, c));
        points->face[f] = vec_scale(sum, 1.0 / n);
    }
}

static void refine_edge_points(const struct topology *t, struct refined_points *points)
{
    uint32_t n_corners = t->cage->face_start[t->cage->n_faces];
    for (uint32_t c = 0; c < n_corners; c++) {
        struct vec ends = vec_add(position(t, c), position(t, corner_next(t, c)));
        uint32_t twin = t->twin[c];
        if (twin == CORNER_NONE) {
            points->edge[c] = vec_scale(ends, 0.5);
            continue;
        }
        /* In the same order from both sides, so that twins hold the same bits. */
        uint32_t low = c < twin ? c : twin, high = c < twin ? twin : c;
        struct vec faces = vec_add(points->face[t->face[low]], points->face[t->face[high]]);
        points->edge[c] = vec_scale(vec_add(ends, faces), 0.25);
    }
}

/* The vertex rule with face points, for faces of any size: (n-2)/n V + (sum e + sum F) / n^2. */
static struct vec refine_vertex(const struct topology *t, const struct refined_points *points,
                                uint32_t c)
{
    struct sector sector = topology_sector(t, c);
    struct vec at = position(t, c), sum = {0, 0, 0};
    if (is_sharp(t, c))
        return at;
    uint32_t last = sector.first;
    for (uint32_t k = 0, walk = last; k < sector.n_faces; k++, walk = corner_ccw(t, walk)) {
        sum = vec_add(sum, position(t, corner_next(t, walk)));
        sum = vec_add(sum, points->face[t->face[walk]]);
        last = walk;
    }
    if (!sector.closed) {
        struct vec ends =
            vec_add(position(t, corner_next(t, sector.first)), position(t, corner_prev(t, last)));
        return vec_mad(vec_scale(at, 0.75), 0.125, ends);
    }
    double n = sector.n_faces;
    return vec_mad(vec_scale(at, (n - 2) / n), 1 / (n * n), sum);
}

bool refined_points_init(struct refined_points *points, const struct topology *t,
                         struct error *error)
{
    const struct cage *cage = t->cage;
    uint32_t n_corners = cage->face_start[cage->n_faces];
    *points = (struct refined_points){
        .vertex = malloc(cage->n_vertices * sizeof(struct vec)),
        .edge = malloc(n_corners * sizeof(struct vec)),
        .face = malloc(cage->n_faces * sizeof(struct vec)),
    };
    uint8_t *done = calloc(cage->n_vertices, 1);
    if (!points->vertex || !points->edge || !points->face || !done) {
        free(done);
        refined_points_finish(points);
        return error_set(error, ERROR_SERVER, "out of memory for the refined cage of %zu faces",
                         cage->n_faces);
    }
    refine_face_points(t, points);
    refine_edge_points(t, points);
    for (uint32_t c = 0; c < n_corners; c++) {
        uint32_t v = corner_vertex(t, c);
        if (!done[v])
            points->vertex[v] = refine_vertex(t, points, c);
        done[v] = 1;
    }
    free(done);
    return true;
}

void refined_points_finish(struct refined_points *points)
{
    free(points->vertex);
    free(points->edge);
    free(points->face);
    *points = (struct refined_points){0};
}

size_t extract_points(const struct topology *t)
{
    const struct cage *cage = t->cage;
    size_t n_corners = cage->face_start[cage->n_faces], largest = 4;
    uint32_t *valence = calloc(cage->n_vertices, sizeof *valence);
    for (uint32_t c = 0; valence && c < n_corners; c++) {
        size_t n = ++valence[corner_vertex(t, c)];
        largest = n > largest ? n : largest;
    }
    for (uint32_t f = 0; f < cage->n_faces; f++)
        largest = face_size(t, f) > largest ? face_size(t, f) : largest;
    /* Without the counts, the one bound that always holds. */
    largest = valence ? largest : n_corners;
    free(valence);
    return 4 * (2 * largest + 1);
}
