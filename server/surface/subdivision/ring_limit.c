#include "server/surface/subdivision/ring_limit.h"

#include "server/surface/node.h"

static const double PI = 3.14159265358979323846;

struct vec ring_limit(const struct ring *ring)
{
    if (ring->sharpness > 0)
        return ring->centre;
    if (!ring->closed || ring_has_outside_crease(ring)) {
        struct vec ends = ring_has_outside_crease(ring)
                              ? vec_add(ring->sheets.end[0], ring->sheets.end[1])
                              : vec_add(ring->edge[0], ring->edge[ring->n_faces]);
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

double ring_eigenvalue(double angle)
{
    double c = cos(angle);
    return (5 + c + sqrt((c + 9) * (c + 1))) / 16;
}

/* Limit tangents of an interior vertex: README.md 4.2 of server/surface. */
static void smooth_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    uint32_t n = ring->n_faces;
    double a = 16 * ring_eigenvalue(2 * PI / n) - 4;
    *t1 = *t2 = (struct vec){0, 0, 0};
    /* Sines and cosines are computed by rotation: calls of sin() and cos() would take most of a
     * large ring's time. */
    double step_x = cos(2 * PI / n), step_y = sin(2 * PI / n), x = 1, y = 0;
    for (uint32_t k = 0; k < n; k++) {
        double next_x = x * step_x - y * step_y, next_y = x * step_y + y * step_x;
        *t1 = vec_mad(*t1, a * x, ring->edge[k]);
        *t1 = vec_mad(*t1, x + next_x, ring->face[k]);
        *t2 = vec_mad(*t2, a * y, ring->edge[k]);
        *t2 = vec_mad(*t2, y + next_y, ring->face[k]);
        x = next_x;
        y = next_y;
    }
}

/* Tangents of a crease sector of two and more quads: left eigenvectors x M = l x of the sector's
 * own subdivision matrix M (old points to new ones), since what such a mask makes of the points
 * shrinks by l in every step. Along the crease that is edge[0] - edge[n] with l = 1/2. Across it,
 * with theta = pi/n, c = cos(theta), s = sin(theta), it is a wave, whose columns of M say:
 *
 *   face k,  weight sin(k theta) + sin((k + 1) theta):   1/4 + a/16 = l, so that a = 16 l - 4;
 *   edge k inside, weight a sin(k theta):                16 l^2 - (10 + 2 c) l + 1 = 0;
 *   edge 0 and n, weight `ends`:                         centre/8 + ends/2 + l s = l ends;
 *   the vertex, weight `centre`:      3/4 centre + ends + (6 l - 1) sum = l centre,
 *                                     sum = s/(1 - c) = that of sin(k theta) over the sector.
 *
 * The well-known mask across (Biermann, Levin and Zorin 2000; OpenSubdiv sdc/catmarkScheme.h) is
 * that of an edge rule which these authors modified beside a crease. Catmull and Clark's rule,
 * by which cages are refined here, has another eigenvector: with three quads and more the normals
 * of a rough surface come to a direction degrees away from that mask's.
 *
 * The wave is the slower of the two, and comes first. */
static void crease_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    uint32_t n = ring->n_faces;
    double theta = PI / n, c = cos(theta), s = sin(theta);
    double l = ring_eigenvalue(theta), a = 16 * l - 4, sum = s / (1 - c);
    double ends = (sum * (6 * l - 1) - 2 * l * s * (3 - 4 * l)) / (2 * (4 * l - 1) * (l - 1));
    double centre = (8 * l - 4) * ends - 8 * l * s;
    *t1 = vec_scale(vec_add(ring->edge[0], ring->edge[n]), ends);
    *t1 = vec_mad(*t1, centre, ring->centre);
    for (uint32_t k = 0; k < n; k++) {
        if (k > 0)
            *t1 = vec_mad(*t1, a * sin(k * theta), ring->edge[k]);
        *t1 = vec_mad(*t1, sin(k * theta) + sin((k + 1) * theta), ring->face[k]);
    }
    *t2 = vec_sub(ring->edge[n], ring->edge[0]);
}

/* A smooth corner of one quad. With S = a (u - v) + b (u^2 + v^2)/2 + c u v in a level's net
 * both borders run along a, and the normal is the limit of S_u x S_v ~ (u + v) a x (b + c).
 * Relative to b, c grows by b/2 from level to level (the matrix's eigenvalue 1/4 has a Jordan
 * block), so that the normal turns at every level, by less and less. The normal is taken that
 * it has at level LIMIT_MIN_LEVELS. */
static void corner_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    struct vec ends = vec_add(ring->edge[0], ring->edge[1]);
    struct vec b = vec_mad(ends, -2, ring->centre);
    struct vec mixed = vec_sub(vec_add(ring->centre, ring->face[0]), ends);
    *t1 = vec_sub(ring->edge[0], ring->edge[1]);
    *t2 = vec_mad(mixed, 1 + LIMIT_MIN_LEVELS / 2.0, b);
}

/* The sum of the quads' own normals at the vertex, for tangents that span no plane. */
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

/* Two quads that share two edges: the difference of the edges and that of the quads shrink by
 * 1/4 each. */
static void lens_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    *t1 = vec_sub(ring->edge[0], ring->edge[1]);
    *t2 = vec_sub(ring->face[0], ring->face[1]);
}

bool ring_has_one_normal(const struct ring *ring)
{
    if (ring_has_outside_crease(ring))
        return false;
    if (ring->closed)
        return !(ring->sharpness > 0);
    return ring->n_faces <= (ring->sharpness > 0 ? 1 : 3);
}

bool ring_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    *t2 = (struct vec){0, 0, 0};
    if (ring->sharpness > 0) {
        uint32_t last = ring_edges(ring) - 1;
        *t1 = vec_sub(ring->edge[0], ring->centre);
        *t2 = vec_sub(ring->edge[last], ring->centre);
    } else if (ring->closed && ring->n_faces > 2) {
        smooth_tangents(ring, t1, t2);
    } else if (ring->closed) {
        lens_tangents(ring, t1, t2);
    } else if (ring->n_faces > 1) {
        crease_tangents(ring, t1, t2);
    } else {
        corner_tangents(ring, t1, t2);
    }
    return ring_has_one_normal(ring);
}

bool ring_frame(const struct ring *ring, struct vec t1, struct vec t2, struct vec axis[3])
{
    bool has_normal = true;
    /* Normalise first: the product of two lengths may leave the range of double. */
    axis[2] = vec_unit(vec_cross(vec_unit(t1), vec_unit(t2)));
    if (vec_length(axis[2]) == 0)
        axis[2] = vec_unit(mean_normal(ring));
    if (vec_length(axis[2]) == 0) {
        axis[2] = (struct vec){0, 0, 1};
        has_normal = false;
    }
    axis[0] = vec_unit(vec_mad(t1, -vec_dot(t1, axis[2]), axis[2]));
    if (vec_length(axis[0]) == 0)
        axis[0] = any_perpendicular(axis[2]);
    axis[1] = vec_cross(axis[2], axis[0]);
    return has_normal;
}
