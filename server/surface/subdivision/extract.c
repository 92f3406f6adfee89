#include "server/surface/subdivision/extract.h"

#include <stdlib.h>

#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/refine.h"
#include "server/surface/subdivision/settle.h"
#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/sharpness.h"

static struct vec vertex_position(const struct topology *t, uint32_t vertex)
{
    const double *p = t->cage->position[vertex];
    return (struct vec){p[0], p[1], p[2]};
}

static struct vec position(const struct topology *t, uint32_t corner)
{
    return vertex_position(t, corner_vertex(t, corner));
}

static struct ring_sheets sheets_beside(const struct topology *t, const struct sector *sector)
{
    const struct nonmanifold_vertex *sheets = nonmanifold_at(t, sector->first);
    if (!sheets)
        return (struct ring_sheets){0};
    uint32_t last = sector->first;
    for (uint32_t k = 1; k < sector->n_faces; k++)
        last = corner_ccw(t, last);
    bool runs_through = !sector->closed && corner_vertex(t, corner_next(t, sector->first)) !=
                                               corner_vertex(t, corner_prev(t, last));
    return (struct ring_sheets){
        .creases = &t->vertex_creases[sheets->first_step],
        .end = {vertex_position(t, sheets->end[0]), vertex_position(t, sheets->end[1])},
        .crease_is_outside = !runs_through,
    };
}

/* The ring of corner c's vertex in the cage. quads: all faces around it are quads; only then
 * ring.face is set. */
static struct ring cage_ring(const struct topology *t, uint32_t c, bool quads,
                             struct sector *sector, struct arena *arena)
{
    *sector = topology_sector(t, c);
    bool creased = t->vertex_flags[corner_vertex(t, c)] & VERTEX_CREASED;
    struct ring ring = ring_take(arena, sector->n_faces, sector->closed, creased);
    ring.at = sector->at;
    ring.sharpness = vertex_sharpness(t, c);
    ring.creases.chaikin = t->cage->chaikin;
    ring.sheets = sheets_beside(t, sector);
    ring.centre = position(t, c);
    for (uint32_t k = 0, at = sector->first; k < sector->n_faces; k++, at = corner_ccw(t, at)) {
        uint32_t next = corner_next(t, at);
        ring.edge[k] = position(t, next);
        if (quads)
            ring.face[k] = position(t, corner_next(t, next));
        if (creased)
            ring.creases.edge[k] = edge_sharpness(t, at);
        if (!sector->closed && k + 1 == sector->n_faces)
            ring.edge[k + 1] = position(t, corner_prev(t, at));
    }
    return ring;
}

/* The sharpness after one step of the half of edge c at the edge's start. */
static float child_sharpness(const struct topology *t, uint32_t c)
{
    return t->child_sharpness ? t->child_sharpness[c] : sharpness_child(edge_sharpness(t, c));
}

static void set_far_sharpness(const struct topology *t, const struct sector *sector,
                              struct ring *ring)
{
    if (!ring->creases.edge)
        return;
    for (uint32_t k = 0, at = sector->first; k < sector->n_faces; k++, at = corner_ccw(t, at)) {
        uint32_t twin = t->twin[at];
        ring->creases.far[k] =
            twin == CORNER_NONE ? CAGE_SHARPNESS_INFINITE : child_sharpness(t, twin);
    }
}

/* Keeps a large ring for all corners of its sector. */
static void share(const struct topology *t, struct ring_cache *rings, enum cached_kind kind,
                  const struct sector *sector, struct ring *ring)
{
    struct cached_ring *kept;
    if (!ring_cache_keep(rings, kind, ring, &kept))
        return;
    for (uint32_t k = 0, at = sector->first; k < sector->n_faces; k++, at = corner_ccw(t, at))
        ring_cache_see_from(rings, kind, at, kept, k);
    *ring = kept->ring;
    ring->at = sector->at;
}

static struct ring vertex_ring(const struct topology *t, uint32_t c, struct ring_cache *rings,
                               struct arena *arena)
{
    struct ring ring;
    if (!ring_cache_find(rings, CACHED_CAGE, c, &ring)) {
        struct sector sector;
        ring = cage_ring(t, c, true, &sector, arena);
        set_far_sharpness(t, &sector, &ring);
        share(t, rings, CACHED_CAGE, &sector, &ring);
    }
    return ring_settle(&ring, arena);
}

/* The refined ring of corner c's vertex, from the face points of its faces. */
static struct ring refine_cage_ring(const struct topology *t, const struct vec *face_points,
                                    uint32_t c, struct sector *sector, struct arena *arena)
{
    struct ring ring = cage_ring(t, c, false, sector, arena);
    set_far_sharpness(t, sector, &ring);
    struct ring out = ring_take(arena, ring.n_faces, ring.closed, ring.creases.edge);
    for (uint32_t k = 0, at = sector->first; k < sector->n_faces; k++, at = corner_ccw(t, at))
        out.face[k] = face_points[t->face[at]];
    ring_refine_around(&ring, &out);
    return out;
}

/* As refine_cage_ring(), but with the edge points of the refined cage, which differ beside smooth
 * triangles. */
static struct ring refined_vertex_ring(const struct topology *t,
                                       const struct refined_points *points, uint32_t c,
                                       struct ring_cache *rings, struct arena *arena)
{
    struct sector sector;
    struct ring ring;
    if (ring_cache_find(rings, CACHED_REFINED_CAGE, c, &ring))
        return ring;
    ring = refine_cage_ring(t, points->face, c, &sector, arena);
    for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at)) {
        ring.edge[k] = points->edge[at];
        if (!sector.closed && k + 1 == sector.n_faces)
            ring.edge[k + 1] = points->edge[corner_prev(t, at)];
    }
    share(t, rings, CACHED_REFINED_CAGE, &sector, &ring);
    return ring;
}

/* The ring around the edge point of half-edge c, in the order: far end, face, start, face
 * across. */
static struct ring refined_edge_ring(const struct topology *t, const struct refined_points *points,
                                     uint32_t c, uint32_t at, struct ring_cache *rings,
                                     struct arena *arena)
{
    uint32_t twin = t->twin[c];
    bool closed = twin != CORNER_NONE;
    bool creased = closed && edge_sharpness(t, c) > 0;
    struct ring ring = ring_take(arena, closed ? 4 : 2, closed, creased);
    ring.at = at;
    ring.creases.chaikin = t->cage->chaikin;
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
    if (creased) {
        struct ring end = refined_vertex_ring(t, points, twin, rings, arena);
        struct ring start = refined_vertex_ring(t, points, c, rings, arena);
        ring.creases.edge[0] = crease_edge(&end, end.at);
        ring.creases.far[0] = crease_child(&end, end.at);
        ring.creases.edge[2] = crease_edge(&start, start.at);
        ring.creases.far[2] = crease_child(&start, start.at);
    }
    return ring_settle(&ring, arena);
}

/* The ring of the face point, for the quad at cage corner c. The ring of a small face begins at c,
 * that of a large face at the face's first corner, so that all its corners share it. Each quad lies
 * between the edge points before and after its corner. */
static struct ring refined_face_ring(const struct topology *t, const struct refined_points *points,
                                     uint32_t c, struct ring_cache *rings, struct arena *arena)
{
    uint32_t start = t->cage->face_start[t->face[c]], n = face_size(t, t->face[c]);
    uint32_t first = n < RING_CACHE_MIN_FACES ? c : start;
    struct cached_ring *kept;
    struct ring ring;
    if (ring_cache_find(rings, CACHED_FACE, c, &ring))
        return ring;
    ring = ring_take(arena, n, true, false);
    ring.at = c - first;
    ring.centre = points->face[t->face[c]];
    for (uint32_t k = 0, at = first; k < n; k++, at = corner_next(t, at)) {
        ring.edge[k] = points->edge[corner_prev(t, at)];
        ring.face[k] = points->vertex[corner_vertex(t, at)];
    }
    if (!ring_cache_keep(rings, CACHED_FACE, &ring, &kept))
        return ring;
    for (uint32_t k = 0; k < n; k++)
        ring_cache_see_from(rings, CACHED_FACE, start + k, kept, k);
    ring = kept->ring;
    ring.at = c - start;
    return ring;
}

struct quad extract_quad(const struct topology *t, uint32_t c, struct ring_cache *rings,
                         struct arena *arena)
{
    struct quad quad;
    for (unsigned i = 0; i < 4; i++, c = corner_next(t, c))
        quad.corner[i] = vertex_ring(t, c, rings, arena);
    return quad;
}

void extract_plain_grid(const struct topology *t, uint32_t c, struct vec grid[4][4])
{
    for (unsigned i = 0; i < 4; i++, c = corner_next(t, c)) {
        const struct quad_corner *at = &quad_corners[i];
        int x = at->x, y = at->y, ax = at->first_x, ay = at->first_y, bx = at->second_x,
            by = at->second_y;
        uint32_t before = corner_cw(t, c), beyond = corner_cw(t, before), after = corner_ccw(t, c);
        grid[y][x] = position(t, c);
        grid[y - by][x - bx] = position(t, corner_next(t, before));
        grid[y - ay - by][x - ax - bx] = position(t, corner_next(t, corner_next(t, beyond)));
        grid[y - ay][x - ax] = position(t, corner_prev(t, after));
    }
}

struct quad extract_refined_quad(const struct topology *t, const struct refined_points *points,
                                 uint32_t c, struct ring_cache *rings, struct arena *arena)
{
    struct quad quad;
    uint32_t before = corner_prev(t, c);
    struct ring vertex = refined_vertex_ring(t, points, c, rings, arena);
    quad.corner[0] = ring_settle(&vertex, arena);
    quad.corner[1] = refined_edge_ring(t, points, c, 1, rings, arena);
    quad.corner[2] = refined_face_ring(t, points, c, rings, arena);
    quad.corner[3] = refined_edge_ring(t, points, before, 0, rings, arena);
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

/* Computes the points of one sector: its vertex, and the edge points of its outgoing half-edges.
 * Marks its corners as done. Each edge point is computed from one of its ends only, so that twins
 * have the same bits. */
static void refine_sector(const struct topology *t, struct refined_points *points, uint32_t c,
                          uint8_t *done, struct arena *arena)
{
    size_t mark = arena->used;
    struct sector sector;
    struct ring ring = refine_cage_ring(t, points->face, c, &sector, arena);
    points->vertex[corner_vertex(t, c)] = ring.centre;
    for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at)) {
        uint32_t twin = t->twin[at];
        done[at] = 1;
        if (twin == CORNER_NONE || at < twin)
            points->edge[at] = ring.edge[k];
        if (twin != CORNER_NONE && at < twin)
            points->edge[twin] = ring.edge[k];
    }
    arena->used = mark;
}

/* The weight of the two face points: OpenSubdiv's constant for triangles (sdc/catmarkScheme.h). */
static double smooth_triangle_weight(const struct topology *t, uint32_t corner)
{
    return face_size(t, t->face[corner]) == 3 ? 0.470 : 0.25;
}

/* OpenSubdiv's TRI_SUB_SMOOTH: in the first step only, face points have a larger weight in edge
 * points beside triangles. */
static bool refine_smooth_triangle_edges(const struct topology *t, struct refined_points *points,
                                         const struct limit_watch *watch, struct error *error)
{
    uint32_t n_corners = t->cage->face_start[t->cage->n_faces];
    for (uint32_t c = 0; c < n_corners; c++) {
        uint32_t twin = t->twin[c];
        if (twin == CORNER_NONE || c > twin)
            continue;
        if (!limit_goes_on(watch, error))
            return false;
        double crease = sharpness_crease_weight(edge_sharpness(t, c), child_sharpness(t, c),
                                                child_sharpness(t, twin));
        double face = 0.5 * (smooth_triangle_weight(t, c) + smooth_triangle_weight(t, twin));
        struct vec ends = vec_add(position(t, c), position(t, corner_next(t, c)));
        struct vec faces = vec_add(points->face[t->face[c]], points->face[t->face[twin]]);
        struct vec smooth = vec_mad(vec_scale(ends, 0.5 - face), face, faces);
        points->edge[c] = vec_mad(vec_scale(smooth, 1 - crease), 0.5 * crease, ends);
        points->edge[twin] = points->edge[c];
    }
    return true;
}

bool refined_points_init(struct refined_points *points, const struct topology *t,
                         struct arena *arena, const struct limit_watch *watch, struct error *error)
{
    const struct cage *cage = t->cage;
    uint32_t n_corners = cage->face_start[cage->n_faces];
    *points = (struct refined_points){
        .vertex = malloc(cage->n_vertices * sizeof(struct vec)),
        .edge = malloc(n_corners * sizeof(struct vec)),
        .face = malloc(cage->n_faces * sizeof(struct vec)),
    };
    uint8_t *done = calloc(n_corners, 1);
    if (!points->vertex || !points->edge || !points->face || !done) {
        free(done);
        refined_points_finish(points);
        return error_set(error, ERROR_SERVER, "out of memory for the refined cage of %zu faces",
                         cage->n_faces);
    }
    refine_face_points(t, points);
    bool ok = true;
    for (uint32_t c = 0; c < n_corners && ok; c++)
        if (!done[c] && (ok = limit_goes_on(watch, error)))
            refine_sector(t, points, c, done, arena);
    free(done);
    return ok && (!cage->smooth_triangles || refine_smooth_triangle_edges(t, points, watch, error));
}

void refined_points_finish(struct refined_points *points)
{
    free(points->vertex);
    free(points->edge);
    free(points->face);
    *points = (struct refined_points){0};
}

size_t extract_largest_ring(const struct topology *t)
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
    /* Without memory for counting, the number of corners is an upper bound. */
    largest = valence ? largest : n_corners;
    free(valence);
    return largest;
}
