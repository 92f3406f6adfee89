#include "server/surface/subdivision/dart_masks.h"

#include <math.h>
#include <string.h>

#include "server/surface/subdivision/refine.h"

enum { MAX_SIZE = 2 * DART_MAX_VALENCE + 2 };
/* The ratio of neighbouring eigenvalues, which decides how fast the iteration converges, is
 * about 0.99 at DART_MAX_VALENCE. */
static const int ITERATIONS = 4000;

/* The ring's points as one array: the vertex, its edges, its faces. */
static struct vec *ring_point(const struct ring *ring, uint32_t i)
{
    uint32_t n = ring_edges(ring);
    return i <= n ? &ring->edge[i - 1] : &ring->face[i - 1 - n];
}

static uint32_t ring_size(const struct ring *ring)
{
    return 1 + ring_edges(ring) + ring->n_faces;
}

static struct vec point(const struct ring *ring, uint32_t i)
{
    return i == 0 ? ring->centre : *ring_point(ring, i);
}

/* matrix[i][j] is the weight of old point j in new point i. */
static void subdivision_matrix(const struct ring *ring, double matrix[MAX_SIZE][MAX_SIZE],
                               struct arena *arena)
{
    uint32_t n = ring_size(ring);
    struct ring in = ring_take(arena, ring->n_faces, true, true);
    struct ring out = ring_take(arena, ring->n_faces, true, true);
    for (uint32_t k = 0; k < ring_edges(ring); k++)
        in.creases.edge[k] = in.creases.far[k] = ring->creases.edge[k];
    for (uint32_t j = 0; j < n; j++) {
        in.centre = (struct vec){j == 0, 0, 0};
        for (uint32_t i = 1; i < n; i++)
            *ring_point(&in, i) = (struct vec){i == j, 0, 0};
        ring_refine(&in, &out);
        for (uint32_t i = 0; i < n; i++)
            matrix[i][j] = point(&out, i).x;
    }
}

static void multiply_left(double matrix[MAX_SIZE][MAX_SIZE], uint32_t n, double *x)
{
    double y[MAX_SIZE] = {0};
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            y[j] += x[i] * matrix[i][j];
    memcpy(x, y, n * sizeof *x);
}

static double dot(const double *a, const double *b, uint32_t n)
{
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static void scale(double *a, uint32_t n, double by)
{
    for (uint32_t i = 0; i < n; i++)
        a[i] *= by;
}

/* A flat star: the ring's points around a regular vertex of that valence. */
static void flat_ring(struct ring *ring)
{
    double step = 2 * 3.14159265358979323846 / ring->n_faces;
    ring->centre = (struct vec){0, 0, 0};
    for (uint32_t k = 0; k < ring->n_faces; k++) {
        ring->edge[k] = (struct vec){cos(k * step), sin(k * step), 0};
        ring->face[k] = (struct vec){cos((k + 0.5) * step), sin((k + 0.5) * step), 0};
    }
}

/* Exchanges the tangents if their order is against the winding. */
static void orient(struct dart_masks *masks, const struct ring *ring, struct arena *arena)
{
    struct ring flat = ring_take(arena, ring->n_faces, true, false);
    flat_ring(&flat);
    struct vec t1 = dart_mask_apply(masks->tangent[0], &flat);
    struct vec t2 = dart_mask_apply(masks->tangent[1], &flat);
    if (vec_cross(t1, t2).z < 0)
        scale(masks->tangent[1], ring_size(ring), -1);
}

/* The left eigenvector of eigenvalue 1, which gives the limit position. */
static void find_position(double matrix[MAX_SIZE][MAX_SIZE], uint32_t n, int iterations,
                          double *position)
{
    double sum = 0;
    memset(position, 0, n * sizeof *position);
    position[0] = 1;
    for (int k = 0; k < iterations; k++)
        multiply_left(matrix, n, position);
    for (uint32_t i = 0; i < n; i++)
        sum += position[i];
    scale(position, n, 1 / sum);
}

/* Removes the part along `position`, which rounding adds: its eigenvalue is larger than those of
 * the tangents, so that it would grow until nothing else is left. */
static void without_position(double *x, uint32_t n, const double *position)
{
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += x[i];
    for (uint32_t i = 0; i < n; i++)
        x[i] -= sum * position[i];
}

/* The next two left eigenvectors: a with the larger eigenvalue, b orthogonal to a. */
static void find_tangents(double matrix[MAX_SIZE][MAX_SIZE], uint32_t n, int iterations,
                          const double *position, double *a, double *b)
{
    for (uint32_t i = 0; i < n; i++) { /* start with any vectors that are not parallel */
        a[i] = sin(1.0 + 7 * i);
        b[i] = cos(2.0 + 5 * i);
    }
    for (int k = 0; k < iterations; k++) {
        multiply_left(matrix, n, a);
        multiply_left(matrix, n, b);
        without_position(a, n, position);
        without_position(b, n, position);
        scale(a, n, 1 / sqrt(dot(a, a, n)));
        double along = dot(a, b, n);
        for (uint32_t i = 0; i < n; i++)
            b[i] -= along * a[i];
        scale(b, n, 1 / sqrt(dot(b, b, n)));
    }
}

void dart_masks_find(struct dart_masks *masks, const struct ring *ring, struct arena *arena)
{
    uint32_t n = ring_size(ring);
    double matrix[MAX_SIZE][MAX_SIZE];
    size_t mark = arena->used;
    int iterations = ring->n_faces <= 8 ? 400 : ITERATIONS;
    subdivision_matrix(ring, matrix, arena);
    find_position(matrix, n, iterations, masks->position);
    find_tangents(matrix, n, iterations, masks->position, masks->tangent[0], masks->tangent[1]);
    orient(masks, ring, arena);
    arena->used = mark;
}

struct vec dart_mask_apply(const double *mask, const struct ring *ring)
{
    struct vec sum = {0, 0, 0};
    for (uint32_t i = 0; i < ring_size(ring); i++)
        sum = vec_mad(sum, mask[i], point(ring, i));
    return sum;
}
