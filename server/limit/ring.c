#include "server/limit/ring.h"

#include <assert.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

bool arena_init(struct arena *arena, size_t capacity)
{
    *arena = (struct arena){malloc(capacity * sizeof(struct vec)), 0, capacity};
    return arena->memory;
}

void arena_finish(struct arena *arena)
{
    free(arena->memory);
    *arena = (struct arena){0};
}

struct vec *arena_take(struct arena *arena, size_t n)
{
    assert(n <= arena->capacity - arena->used);
    struct vec *taken = arena->memory + arena->used;
    arena->used += n;
    return taken;
}

struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed)
{
    struct ring ring = {.n_faces = n_faces, .closed = closed};
    ring.edge = arena_take(arena, ring_edges(&ring));
    ring.face = arena_take(arena, n_faces);
    return ring;
}

static void refine_faces(const struct ring *in, struct ring *out)
{
    uint32_t n = ring_edges(in);
    for (uint32_t k = 0; k < in->n_faces; k++) {
        struct vec next = in->edge[k + 1 == n ? 0 : k + 1];
        struct vec sum = vec_add(vec_add(in->centre, in->face[k]), vec_add(in->edge[k], next));
        out->face[k] = vec_scale(sum, 0.25);
    }
}

static void refine_edges(const struct ring *in, struct ring *out)
{
    uint32_t n = ring_edges(in);
    for (uint32_t k = 0; k < n; k++) {
        struct vec ends = vec_add(in->centre, in->edge[k]);
        if (!in->closed && (k == 0 || k == in->n_faces)) {
            out->edge[k] = vec_scale(ends, 0.5);
            continue;
        }
        struct vec sides = vec_add(out->face[k ? k - 1 : in->n_faces - 1], out->face[k]);
        out->edge[k] = vec_scale(vec_add(ends, sides), 0.25);
    }
}

static struct vec refine_centre(const struct ring *in, const struct ring *out)
{
    if (in->sharp)
        return in->centre;
    if (!in->closed) {
        struct vec ends = vec_add(in->edge[0], in->edge[in->n_faces]);
        return vec_mad(vec_scale(in->centre, 0.75), 0.125, ends);
    }
    double n = in->n_faces;
    struct vec sum = {0, 0, 0};
    for (uint32_t k = 0; k < in->n_faces; k++)
        sum = vec_add(sum, vec_add(in->edge[k], out->face[k]));
    return vec_mad(vec_scale(in->centre, (n - 2) / n), 1 / (n * n), sum);
}

void ring_refine(const struct ring *in, struct ring *out)
{
    refine_faces(in, out);
    refine_edges(in, out);
    out->centre = refine_centre(in, out);
    out->n_faces = in->n_faces;
    out->at = in->at;
    out->closed = in->closed;
    out->sharp = in->sharp;
}

struct vec ring_limit(const struct ring *ring)
{
    if (ring->sharp)
        return ring->centre;
    if (!ring->closed) {
        struct vec ends = vec_add(ring->edge[0], ring->edge[ring->n_faces]);
        return vec_mad(vec_scale(ring->centre, 2.0 / 3), 1.0 / 6, ends);
    }
    double n = ring->n_faces;
    struct vec edges = {0, 0, 0}, faces = {0, 0, 0};
    for (uint32_t k = 0; k < ring->n_faces; k++) {
        edges = vec_add(edges, ring->edge[k]);
        faces = vec_add(faces, ring->face[k]);
    }
    struct vec limit = vec_scale(ring->centre, n / (n + 5));
    limit = vec_mad(limit, 4 / (n * (n + 5)), edges);
    return vec_mad(limit, 1 / (n * (n + 5)), faces);
}

/* Limit tangents of an interior vertex: the masks of limit-surface 4.6. */
static void smooth_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    uint32_t n = ring->n_faces;
    double c = cos(2 * PI / n);
    double a = 1 + c + cos(PI / n) * sqrt(2 * (9 + c));
    *t1 = *t2 = (struct vec){0, 0, 0};
    for (uint32_t k = 0; k < n; k++) {
        double p = 2 * PI * k / n, q = 2 * PI * (k + 1) / n;
        *t1 = vec_mad(*t1, a * cos(p), ring->edge[k]);
        *t1 = vec_mad(*t1, cos(p) + cos(q), ring->face[k]);
        *t2 = vec_mad(*t2, a * sin(p), ring->edge[k]);
        *t2 = vec_mad(*t2, sin(p) + sin(q), ring->face[k]);
    }
}

/* Tangents of a crease sector of two and more quads: along the crease, and across it (Biermann,
 * Levin and Zorin 2000; OpenSubdiv sdc/catmarkScheme.h). */
static void crease_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    uint32_t n = ring->n_faces;
    double theta = PI / n, c = cos(theta), s = sin(theta), r = (c + 1) / s;
    *t1 = vec_sub(ring->edge[0], ring->edge[n]);
    *t2 = vec_scale(ring->centre, 4 * r * (c - 1));
    *t2 = vec_mad(*t2, -r * (1 + 2 * c), vec_add(ring->edge[0], ring->edge[n]));
    *t2 = vec_mad(*t2, s, ring->face[0]);
    for (uint32_t k = 1; k < n; k++) {
        *t2 = vec_mad(*t2, 4 * sin(k * theta), ring->edge[k]);
        *t2 = vec_mad(*t2, sin(k * theta) + sin((k + 1) * theta), ring->face[k]);
    }
}

/* A smooth corner of one quad: both borders run along a, and the normal is the limit of
 * S_u x S_v ~ (u + v) a x (b + c) with S = a (u - v) + b (u^2 + v^2)/2 + c u v. */
static void corner_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    struct vec ends = vec_add(ring->edge[0], ring->edge[1]);
    struct vec b = vec_mad(ends, -2, ring->centre);
    struct vec mixed = vec_sub(vec_add(ring->centre, ring->face[0]), ends);
    *t1 = vec_sub(ring->edge[0], ring->edge[1]);
    *t2 = vec_add(b, mixed);
}

/* The mean of the quads' own normals at the vertex: for vertices without tangent masks. */
static struct vec mean_normal(const struct ring *ring)
{
    struct vec sum = {0, 0, 0};
    uint32_t n = ring_edges(ring);
    for (uint32_t k = 0; k < ring->n_faces; k++) {
        struct vec a = vec_sub(ring->edge[k], ring->centre);
        struct vec b = vec_sub(ring->edge[k + 1 == n ? 0 : k + 1], ring->centre);
        sum = vec_add(sum, vec_cross(a, b));
    }
    return sum;
}

static struct vec any_perpendicular(struct vec n)
{
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    struct vec other = {x <= y && x <= z, y < x && y <= z, z < x && z < y};
    return vec_unit(vec_cross(n, other));
}

void ring_frame(const struct ring *ring, struct vec axis[3])
{
    struct vec t1 = {0, 0, 0}, t2 = {0, 0, 0};
    if (ring->closed && ring->n_faces > 2)
        smooth_tangents(ring, &t1, &t2);
    else if (!ring->closed && !ring->sharp && ring->n_faces > 1)
        crease_tangents(ring, &t1, &t2);
    else if (!ring->closed && !ring->sharp)
        corner_tangents(ring, &t1, &t2);
    /* Unit first: the product of two lengths may leave the range of double. */
    axis[2] = vec_unit(vec_cross(vec_unit(t1), vec_unit(t2)));
    if (vec_length(axis[2]) == 0)
        axis[2] = vec_unit(mean_normal(ring));
    if (vec_length(axis[2]) == 0)
        axis[2] = (struct vec){0, 0, 1};
    axis[0] = vec_unit(vec_mad(t1, -vec_dot(t1, axis[2]), axis[2]));
    if (vec_length(axis[0]) == 0)
        axis[0] = any_perpendicular(axis[2]);
    axis[1] = vec_cross(axis[2], axis[0]);
}
