#include "server/surface/subdivision/ring.h"

#include <string.h>

#include "server/surface/topology/nonmanifold.h"
#include "server/surface/tables.h"

static const double PI = 3.14159265358979323846;

struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed, bool with_creases)
{
    struct ring ring = {.n_faces = n_faces, .closed = closed};
    uint32_t n_edges = ring_edges(&ring);
    ring.edge = arena_take(arena, n_edges * sizeof(struct vec));
    ring.face = arena_take(arena, n_faces * sizeof(struct vec));
    if (with_creases) {
        ring.creases.edge = arena_take(arena, 2 * n_edges * sizeof(float));
        ring.creases.far = ring.creases.edge + n_edges;
        memset(ring.creases.edge, 0, 2 * n_edges * sizeof(float));
    }
    return ring;
}

size_t ring_bytes(size_t n_faces, bool with_creases)
{
    size_t points = (2 * n_faces + 1) * sizeof(struct vec);
    return points + (with_creases ? 2 * (n_faces + 1) * sizeof(float) : 0) + 48;
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
    for (uint32_t k = 0; k < ring_edges(in); k++) {
        struct vec ends = vec_add(in->centre, in->edge[k]);
        double crease = crease_edge_weight(in, k);
        if (crease == 1) {
            out->edge[k] = vec_scale(ends, 0.5);
            continue;
        }
        struct vec sides = vec_add(out->face[k ? k - 1 : in->n_faces - 1], out->face[k]);
        struct vec smooth = vec_scale(vec_add(ends, sides), 0.25);
        out->edge[k] = vec_mad(vec_scale(smooth, 1 - crease), 0.5 * crease, ends);
    }
}

/* One rule's new vertex. */
static struct vec centre_by_rule(const struct ring *in, const struct ring *out,
                                 enum crease_rule rule, const uint32_t end[2])
{
    if (rule == RULE_CORNER)
        return in->centre;
    if (rule == RULE_CREASE) {
        const struct vec *foreign = in->sheets.creases ? in->sheets.end : NULL;
        struct vec ends =
            foreign ? vec_add(foreign[0], foreign[1]) : vec_add(in->edge[end[0]], in->edge[end[1]]);
        return vec_mad(vec_scale(in->centre, 0.75), 0.125, ends);
    }
    double n = in->n_faces;
    struct vec sum = {0, 0, 0};
    for (uint32_t k = 0; k < in->n_faces; k++)
        sum = vec_add(sum, vec_add(in->edge[k], out->face[k]));
    return vec_mad(vec_scale(in->centre, (n - 2) / n), 1 / (n * n), sum);
}

/* How much of the parent's rule remains as sharpness runs out: the mean of what runs out now, in
 * single precision as sharpness is everywhere. */
static double rule_weight(const struct ring *in, const struct ring *out)
{
    const struct vertex_creases *sheets = in->sheets.creases;
    struct crease_sum ending = {0, 0};
    if (out->sharpness <= 0)
        crease_add(&ending, in->sharpness);
    for (uint32_t k = 0; !sheets && in->creases.edge && k < ring_edges(in); k++)
        if (crease_edge(out, k) <= 0)
            crease_add(&ending, crease_edge(in, k));
    /* The rule changes where they have all run out, so that none is left over here. */
    if (sheets) {
        ending.sum += sheets->semisharp.sum;
        ending.n += sheets->semisharp.n;
    }
    return ending.n ? fmin((double)(ending.sum / (float)ending.n), 1) : 0;
}

static struct vec refine_centre(const struct ring *in, const struct ring *out)
{
    uint32_t end[2], child_end[2];
    enum crease_rule rule = crease_vertex_rule(in, end);
    struct vec centre = centre_by_rule(in, out, rule, end);
    if (rule == RULE_SMOOTH || rule == RULE_DART)
        return centre;
    enum crease_rule child = crease_vertex_rule(out, child_end);
    if (child == rule)
        return centre;
    double weight = rule_weight(in, out);
    struct vec other = centre_by_rule(in, out, child, child_end);
    return vec_mad(vec_scale(centre, weight), 1 - weight, other);
}

void ring_refine_around(const struct ring *in, struct ring *out)
{
    out->at = in->at;
    out->cut_extraordinary = in->cut_extraordinary;
    crease_refine(in, out);
    refine_edges(in, out);
    for (int k = 0; k < 2; k++)
        out->sheets.end[k] = vec_scale(vec_add(in->centre, in->sheets.end[k]), 0.5);
    out->centre = refine_centre(in, out);
}

void ring_refine(const struct ring *in, struct ring *out)
{
    refine_faces(in, out);
    ring_refine_around(in, out);
}

struct vec ring_limit(const struct ring *ring)
{
    if (ring->sharpness > 0)
        return ring->centre;
    if (!ring->closed || ring_has_foreign_crease(ring)) {
        struct vec ends = ring_has_foreign_crease(ring)
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

/* Limit tangents of an interior vertex: the masks of limit-surface 4.6. */
static void smooth_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    uint32_t n = ring->n_faces;
    double a = 16 * ring_eigenvalue(2 * PI / n) - 4;
    *t1 = *t2 = (struct vec){0, 0, 0};
    /* Around the circle by rotation: sines and cosines would be most of a large ring's cost. */
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

/* A smooth corner of one quad: both borders run along a, and the normal is the limit of
 * S_u x S_v ~ (u + v) a x (b + c) with S = a (u - v) + b (u^2 + v^2)/2 + c u v. Of a level's net,
 * that is: from level to level b stays and c grows by b/2 (the matrix's eigenvalue 1/4 has a Jordan
 * block), so that the normal turns for ever, ever less. Taken is what it has come to at the last
 * level of a table. */
static void corner_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    struct vec ends = vec_add(ring->edge[0], ring->edge[1]);
    struct vec b = vec_mad(ends, -2, ring->centre);
    struct vec mixed = vec_sub(vec_add(ring->centre, ring->face[0]), ends);
    *t1 = vec_sub(ring->edge[0], ring->edge[1]);
    *t2 = vec_mad(mixed, 1 + LIMIT_MIN_LEVELS / 2.0, b);
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

/* Two quads that share two edges: both edges' and both quads' differences shrink by 1/4. */
static void lens_tangents(const struct ring *ring, struct vec *t1, struct vec *t2)
{
    *t1 = vec_sub(ring->edge[0], ring->edge[1]);
    *t2 = vec_sub(ring->face[0], ring->face[1]);
}

bool ring_has_one_normal(const struct ring *ring)
{
    if (ring_has_foreign_crease(ring))
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
    /* Unit first: the product of two lengths may leave the range of double. */
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
