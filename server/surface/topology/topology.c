#include "server/surface/topology/topology.h"

#include <stdlib.h>
#include <string.h>

#include "server/surface/topology/nonmanifold.h"

/* The edges around each vertex, counted while half-edges are paired. */
struct vertex_count {
    uint32_t edges, boundary, nonmanifold, faces;
};

/* A half-edge, in the list of those with the same lower vertex, in which they are paired by their
 * higher one. */
struct half_edge {
    uint32_t high, corner;
    bool forward; /* goes from the lower to the higher vertex */
};

static int compare_half_edges(const void *a, const void *b)
{
    const struct half_edge *p = a, *q = b;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return p->corner < q->corner ? -1 : p->corner > q->corner;
}

static void count_edge(struct vertex_count *count, uint32_t low, uint32_t high, bool boundary,
                       bool nonmanifold)
{
    const uint32_t end[2] = {low, high};
    for (int i = 0; i < 2; i++) {
        count[end[i]].edges++;
        count[end[i]].boundary += boundary;
        count[end[i]].nonmanifold += nonmanifold;
    }
}

static void pair_bucket(struct topology *t, struct half_edge *bucket, size_t n, uint32_t low,
                        struct vertex_count *count)
{
    qsort(bucket, n, sizeof *bucket, compare_half_edges);
    for (size_t first = 0, last; first < n; first = last) {
        for (last = first + 1; last < n && bucket[last].high == bucket[first].high; last++)
            ;
        bool paired = last - first == 2 && bucket[first].forward != bucket[first + 1].forward;
        if (paired) {
            t->twin[bucket[first].corner] = bucket[first + 1].corner;
            t->twin[bucket[first + 1].corner] = bucket[first].corner;
        }
        bool boundary = last - first == 1;
        uint32_t c = bucket[first].corner;
        float sharpness = t->edge_sharpness ? t->edge_sharpness[c] : 0;
        if (boundary && sharpness < CAGE_SHARPNESS_INFINITE) {
            t->vertex_flags[low] |= VERTEX_UNBOUND;
            t->vertex_flags[bucket[first].high] |= VERTEX_UNBOUND;
        }
        count_edge(count, low, bucket[first].high, boundary, !paired && !boundary);
    }
}

static bool pair_half_edges(struct topology *t, struct vertex_count *count)
{
    const struct cage *cage = t->cage;
    size_t n_corners = cage->face_start[cage->n_faces];
    size_t *start = calloc(cage->n_vertices + 2, sizeof *start);
    struct half_edge *sorted = malloc(n_corners * sizeof *sorted);
    if (!start || !sorted) {
        free(start);
        free(sorted);
        return false;
    }
    for (int fill = 0; fill < 2; fill++) {
        for (uint32_t c = 0; c < n_corners; c++) {
            uint32_t a = corner_vertex(t, c), b = corner_vertex(t, corner_next(t, c));
            uint32_t low = a < b ? a : b;
            if (fill)
                sorted[start[low + 1]++] = (struct half_edge){a < b ? b : a, c, a < b};
            else
                start[low + 2]++;
        }
        /* After this loop v's bucket begins at start[v + 1]. The second pass moves that to the
         * bucket's end, so that the bucket of v is start[v] .. start[v + 1]. */
        for (size_t v = 2; !fill && v < cage->n_vertices + 2; v++)
            start[v] += start[v - 1];
    }
    for (uint32_t v = 0; v < cage->n_vertices; v++)
        pair_bucket(t, sorted + start[v], start[v + 1] - start[v], v, count);
    free(start);
    free(sorted);
    return true;
}

static bool vertex_is_manifold(const struct topology *t, uint32_t corner,
                               const struct vertex_count *count)
{
    return count->nonmanifold == 0 && topology_sector(t, corner).n_faces == count->faces;
}

/* True if the surface passes through the vertex, by OpenSubdiv's rule
 * (far/topologyRefinerFactory.cpp). */
static bool vertex_is_sharp(const struct topology *t, bool manifold,
                            const struct vertex_count *count)
{
    if (count->faces == 1 && count->edges == 2 &&
        t->cage->boundary == CAGE_BOUNDARY_EDGE_AND_CORNER)
        return true;
    if (manifold)
        return false;
    /* A fin follows the crease rule: two opposite edges of several faces each, and no boundary. */
    return !(count->nonmanifold == 2 && count->boundary == 0 && count->faces > count->edges);
}

static void flag_vertices(struct topology *t, struct vertex_count *count)
{
    const struct cage *cage = t->cage;
    size_t n_corners = cage->face_start[cage->n_faces];
    for (uint32_t c = 0; c < n_corners; c++)
        count[corner_vertex(t, c)].faces++;
    for (uint32_t c = 0; c < n_corners; c++) {
        uint32_t v = corner_vertex(t, c);
        uint8_t *flags = &t->vertex_flags[v];
        if (face_size(t, t->face[c]) != 4)
            *flags |= VERTEX_BY_NGON;
        if (count[v].faces == 0)
            continue; /* an earlier corner of this vertex has set its flags */
        bool manifold = vertex_is_manifold(t, c, &count[v]);
        if (!manifold)
            *flags |= VERTEX_NON_MANIFOLD;
        if (vertex_is_sharp(t, manifold, &count[v]))
            *flags |= VERTEX_SHARP;
        if (count[v].faces == 4 && count[v].edges == 4 && !count[v].boundary &&
            !count[v].nonmanifold)
            *flags |= VERTEX_PLAIN;
        count[v].faces = 0;
    }
}

/* The half-edges from each vertex, to find the edge of a crease. */
struct outgoing {
    uint32_t *first; /* [vertices + 1] */
    uint32_t *corner;
};

static bool outgoing_init(struct outgoing *out, const struct topology *t)
{
    const struct cage *cage = t->cage;
    uint32_t n_corners = cage->face_start[cage->n_faces];
    out->first = calloc(cage->n_vertices + 2, sizeof *out->first);
    out->corner = malloc(n_corners * sizeof *out->corner);
    if (!out->first || !out->corner) {
        free(out->first);
        free(out->corner);
        return false;
    }
    for (uint32_t c = 0; c < n_corners; c++)
        out->first[corner_vertex(t, c) + 2]++;
    for (size_t v = 2; v < cage->n_vertices + 2; v++)
        out->first[v] += out->first[v - 1];
    for (uint32_t c = 0; c < n_corners; c++)
        out->corner[out->first[corner_vertex(t, c) + 1]++] = c;
    return true;
}

/* Sets the sharpness of the half-edges from a to b. Returns their number. */
static size_t sharpen_from(struct topology *t, const struct outgoing *out, uint32_t a, uint32_t b,
                           float sharpness)
{
    size_t n = 0;
    for (uint32_t k = out->first[a]; k < out->first[a + 1]; k++) {
        uint32_t c = out->corner[k];
        if (corner_vertex(t, corner_next(t, c)) != b)
            continue;
        t->edge_sharpness[c] = sharpness;
        n++;
    }
    return n;
}

static bool sharpen_edges(struct topology *t, struct error *error)
{
    const struct cage *cage = t->cage;
    if (!cage->n_creases)
        return true;
    struct outgoing out;
    t->edge_sharpness = calloc(cage->face_start[cage->n_faces], sizeof *t->edge_sharpness);
    if (!t->edge_sharpness || !outgoing_init(&out, t))
        return error_set(error, ERROR_SERVER, "out of memory for %zu creases", cage->n_creases);
    bool ok = true;
    for (size_t i = 0; i < cage->n_creases && ok; i++) {
        const struct cage_crease *crease = &cage->crease[i];
        uint32_t a = crease->vertex[0], b = crease->vertex[1];
        size_t n = sharpen_from(t, &out, a, b, crease->sharpness);
        n += sharpen_from(t, &out, b, a, crease->sharpness);
        if (!n)
            ok = error_set(error, ERROR_MODEL, "crease %zu: vertices %u and %u share no edge", i, a,
                           b);
    }
    free(out.first);
    free(out.corner);
    return ok;
}

static void flag_creased_vertices(struct topology *t)
{
    uint32_t n_corners = t->cage->face_start[t->cage->n_faces];
    for (uint32_t c = 0; c < n_corners && t->edge_sharpness; c++) {
        if (t->twin[c] == CORNER_NONE || t->edge_sharpness[c] <= 0)
            continue;
        t->vertex_flags[corner_vertex(t, c)] |= VERTEX_CREASED;
        t->vertex_flags[corner_vertex(t, corner_next(t, c))] |= VERTEX_CREASED;
    }
}

static bool sharpen_vertices(struct topology *t, struct error *error)
{
    const struct cage *cage = t->cage;
    if (!cage->n_corners)
        return true;
    t->vertex_sharpness = calloc(cage->n_vertices, sizeof *t->vertex_sharpness);
    if (!t->vertex_sharpness)
        return error_set(error, ERROR_SERVER, "out of memory for %zu sharp vertices",
                         cage->n_corners);
    for (size_t i = 0; i < cage->n_corners; i++) {
        t->vertex_sharpness[cage->corner[i].vertex] = cage->corner[i].sharpness;
        if (cage->corner[i].sharpness > 0)
            t->vertex_flags[cage->corner[i].vertex] |= VERTEX_TAGGED;
    }
    return true;
}

/* The semi-sharp edges around a vertex. */
static struct sharpness_sum sum_creases(const struct topology *t, const struct sector *sector)
{
    const struct nonmanifold_vertex *sheets = nonmanifold_at(t, sector->first);
    struct sharpness_sum sum = {0, 0};
    if (sheets)
        return t->vertex_creases[sheets->first_step].semisharp;
    for (uint32_t k = 0, at = sector->first; k < sector->n_faces; k++, at = corner_ccw(t, at))
        sharpness_add(&sum, edge_sharpness(t, at));
    return sum;
}

/* The rule for each edge needs all edges around the vertex: their sum is computed once for a
 * sector. */
static bool find_child_sharpness(struct topology *t)
{
    uint32_t n_corners = t->cage->face_start[t->cage->n_faces];
    if (!t->cage->chaikin || !t->edge_sharpness)
        return true;
    t->child_sharpness = malloc(n_corners * sizeof *t->child_sharpness);
    if (!t->child_sharpness)
        return false;
    for (uint32_t c = 0; c < n_corners; c++)
        t->child_sharpness[c] = -1;
    for (uint32_t c = 0; c < n_corners; c++) {
        if (t->child_sharpness[c] >= 0)
            continue;
        struct sector sector = topology_sector(t, c);
        struct sharpness_sum sum = sum_creases(t, &sector);
        for (uint32_t k = 0, at = sector.first; k < sector.n_faces; k++, at = corner_ccw(t, at))
            t->child_sharpness[at] = sharpness_child_chaikin(edge_sharpness(t, at), &sum);
    }
    return true;
}

bool topology_init(struct topology *t, const struct cage *cage, struct error *error)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    *t = (struct topology){
        .cage = cage,
        .twin = malloc(n_corners * sizeof *t->twin),
        .face = malloc(n_corners * sizeof *t->face),
        .vertex_flags = calloc(cage->n_vertices, 1),
        .quads_only = true,
    };
    struct vertex_count *count = calloc(cage->n_vertices, sizeof *count);
    if (!t->twin || !t->face || !t->vertex_flags || !count)
        goto no_memory;
    memset(t->twin, 0xff, n_corners * sizeof *t->twin);
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        for (uint32_t c = cage->face_start[f]; c < cage->face_start[f + 1]; c++)
            t->face[c] = f;
        t->quads_only &= face_size(t, f) == 4;
    }
    if (!sharpen_edges(t, error) || !sharpen_vertices(t, error))
        goto fail;
    if (!pair_half_edges(t, count))
        goto no_memory;
    flag_vertices(t, count);
    flag_creased_vertices(t);
    if (!nonmanifold_find(t) || !find_child_sharpness(t))
        goto no_memory;
    free(count);
    return true;

no_memory:
    error_set(error, ERROR_SERVER, "out of memory for the topology of %zu faces", cage->n_faces);
fail:
    free(count);
    topology_finish(t);
    return false;
}

void topology_finish(struct topology *t)
{
    free(t->twin);
    free(t->face);
    free(t->vertex_flags);
    free(t->edge_sharpness);
    free(t->child_sharpness);
    free(t->vertex_sharpness);
    free(t->nonmanifold);
    free(t->vertex_creases);
    *t = (struct topology){0};
}
