#include "server/surface/subdivision/corner.h"

#include <math.h>
#include <string.h>

#include "server/surface/bound.h"
#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/refine.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/subdivision/ring_limit.h"
#include "server/surface/subdivision/settle.h"
#include "server/surface/texels.h"

/* Each level makes one more edge at either end of a window wrong. The window is so wide that the
 * edges used by the grid stay right. */
enum { WINDOW_SIDE = LIMIT_MAX_LEVELS + 3, WINDOW = 2 * WINDOW_SIDE };

static bool needs_window(const struct ring *ring)
{
    return ring->n_faces > WINDOW + 2 && !ring->creases.edge;
}

/* The first edge of the window in the ring. */
static uint32_t window_start(const struct ring *ring)
{
    if (ring->closed)
        return (ring->at + ring->n_faces - WINDOW_SIDE) % ring->n_faces;
    uint32_t last = ring->n_faces - WINDOW;
    uint32_t first = ring->at < WINDOW_SIDE ? 0 : ring->at - WINDOW_SIDE;
    return first < last ? first : last;
}

/* ring_limit() of the whole ring, from what was stored with the window. */
static struct vec window_limit(const struct net *net)
{
    double n = net->n_faces;
    if (net->window == WINDOW_ENDS) {
        struct vec ends = vec_add(net->end[0], net->end[1]);
        return vec_mad(vec_scale(net->ring.centre, 2.0 / 3), 1.0 / 6, ends);
    }
    struct vec limit = vec_scale(net->ring.centre, n / (n + 5));
    limit = vec_mad(limit, 4 / (n * (n + 5)), net->edges);
    return vec_mad(limit, 1 / (n * (n + 5)), net->faces);
}

/* ring_refine() for the vertex of a crease and the crease's two ends. */
static void refine_window_ends(const struct net *in, struct net *out)
{
    struct vec ends = vec_add(in->end[0], in->end[1]);
    for (int k = 0; k < 2; k++)
        out->end[k] = vec_scale(vec_add(in->ring.centre, in->end[k]), 0.5);
    out->ring.centre = vec_mad(vec_scale(in->ring.centre, 0.75), 0.125, ends);
}

/* ring_refine() for a smooth vertex and for the sums over all edges and faces (README.md eq. 5
 * of server/surface). */
static void refine_window_sums(const struct net *in, struct net *out)
{
    double n = in->n_faces;
    struct vec whole = vec_scale(in->ring.centre, n);
    struct vec both = vec_mad(in->faces, 2, in->edges);
    out->faces = vec_scale(vec_add(whole, both), 0.25);
    out->edges = vec_scale(vec_mad(vec_add(whole, in->edges), 2, out->faces), 0.25);
    struct vec sum = vec_add(in->edges, out->faces);
    out->ring.centre = vec_mad(vec_scale(in->ring.centre, (n - 2) / n), 1 / (n * n), sum);
}

static struct vec limit_position(const struct ring *ring, const struct dart_masks *masks)
{
    return ring_is_dart(ring) ? dart_mask_apply(masks->position, ring) : ring_cache_limit(ring);
}

static struct vec to_frame(struct vec p, struct vec origin, const struct vec axis[3])
{
    struct vec d = vec_sub(p, origin);
    return (struct vec){vec_dot(d, axis[0]), vec_dot(d, axis[1]), vec_dot(d, axis[2])};
}

/* Sets the phantom points (README.md eq. 3 of server/surface) beyond edges of the quad where
 * its sector ends. */
static void phantom_points(const struct ring *ring, struct vec grid[5][5])
{
    bool first = ring_ends_at(ring, 0), second = ring_ends_at(ring, 1);
    for (int k = 1; k < 5; k++) {
        if (second)
            grid[k][0] = vec_sub(vec_scale(grid[k][1], 2), grid[k][2]);
        if (first)
            grid[0][k] = vec_sub(vec_scale(grid[1][k], 2), grid[2][k]);
    }
}

/* The net of level 0 in a frame: only i,j <= 2 are set. */
static void first_net(const struct quad *quad, const struct vertex_limit *vertex,
                      const struct vec axis[3], struct net *net)
{
    struct vec grid[4][4], origin = vertex->limit;
    quad_grid(quad, grid);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            net->grid[j][i] = to_frame(grid[j][i], origin, axis);
    const struct ring *ring = &quad->corner[0];
    uint32_t n = ring_edges(ring), shift = needs_window(ring) ? window_start(ring) : 0;
    net->ring.at = (ring->at + n - shift) % n;
    net->ring.sharpness = ring->sharpness;
    net->ring.centre = to_frame(ring->centre, origin, axis);
    for (uint32_t k = 0; k < ring_edges(&net->ring); k++)
        net->ring.edge[k] = to_frame(ring->edge[(k + shift) % n], origin, axis);
    for (uint32_t k = 0; k < net->ring.n_faces; k++)
        net->ring.face[k] = to_frame(ring->face[(k + shift) % n], origin, axis);
    for (uint32_t k = 0; ring->creases.edge && k < n; k++)
        net->ring.creases.edge[k] = net->ring.creases.far[k] = ring->creases.edge[k];
    net->n_faces = ring->n_faces;
    bool is_outside = ring_has_outside_crease(ring);
    if (is_outside || (needs_window(ring) && !(ring->sharpness > 0)))
        net->window = ring->closed && !is_outside ? WINDOW_SUMS : WINDOW_ENDS;
    net->edges = vertex->edges;
    net->faces = vertex->faces;
    for (int k = 0; k < 2; k++)
        net->end[k] =
            to_frame(is_outside ? ring->sheets.end[k] : ring->edge[k ? n - 1 : 0], origin, axis);
    phantom_points(&net->ring, net->grid);
}

/* Catmull-Clark at grid point (i,j) of the finer net, by the parity of i and j (server/surface/README.md 3.2).
 * Reads only points with i,j = -1..2, and never (-1,-1) for the points it is asked for. */
static struct vec refine_point(struct vec grid[5][5], int i, int j)
{
    int a = (i + 2) / 2 - 1, b = (j + 2) / 2 - 1; /* floor(i/2), floor(j/2) for i,j >= -2 */
    enum { UP = 5 };                              /* distance of rows */
    const struct vec *g = &grid[0][0] + (b + 1) * UP + a + 1;
    if (i & 1 && j & 1)
        return vec_scale(vec_add(vec_add(g[0], g[1]), vec_add(g[UP], g[UP + 1])), 0.25);
    if (i & 1 || j & 1) {
        int along = i & 1 ? 1 : UP, across = i & 1 ? UP : 1;
        struct vec ends = vec_add(g[0], g[along]);
        struct vec wings =
            vec_add(vec_add(g[-across], g[along - across]), vec_add(g[across], g[along + across]));
        return vec_mad(vec_scale(ends, 0.375), 0.0625, wings);
    }
    struct vec edges = vec_add(vec_add(g[-1], g[1]), vec_add(g[-UP], g[UP]));
    struct vec faces = vec_add(vec_add(g[-UP - 1], g[-UP + 1]), vec_add(g[UP - 1], g[UP + 1]));
    return vec_mad(vec_mad(vec_scale(g[0], 0.5625), 0.09375, edges), 0.015625, faces);
}

/* Takes the points around the vertex from its refined ring, and phantom points beyond a sector's
 * end. */
static void ring_points(const struct ring *ring, struct vec grid[5][5])
{
    grid[1][1] = ring->centre;
    grid[1][2] = ring_edge(ring, 0);
    grid[2][2] = ring_face(ring, 0);
    grid[2][1] = ring_edge(ring, 1);
    if (ring_has_face(ring, 1)) {
        grid[2][0] = ring_face(ring, 1);
        grid[1][0] = ring_edge(ring, 2);
    }
    if (ring_has_face(ring, -1)) {
        grid[0][2] = ring_face(ring, -1);
        grid[0][1] = ring_edge(ring, -1);
    }
}

/* Computes the net of the next level: refines, then moves the limit position back to zero. */
static void next_net(const struct net *in, const struct dart_masks *masks, struct net *out)
{
    struct vec coarse[5][5];
    for (int j = 0; j < 5; j++)
        for (int i = 0; i < 5; i++)
            coarse[j][i] = in->grid[j][i];
    for (int j = -1; j <= 3; j++)
        for (int i = -1; i <= 3; i++)
            if (i > 1 || j > 1)
                out->grid[j + 1][i + 1] = refine_point(coarse, i, j);
    ring_refine(&in->ring, &out->ring);
    out->window = in->window;
    out->n_faces = in->n_faces;
    if (in->window == WINDOW_SUMS)
        refine_window_sums(in, out);
    else if (in->window == WINDOW_ENDS)
        refine_window_ends(in, out);
    ring_points(&out->ring, out->grid);
    phantom_points(&out->ring, out->grid);

    struct vec limit = in->window ? window_limit(out) : limit_position(&out->ring, masks);
    out->edges = vec_mad(out->edges, -in->n_faces, limit);
    out->faces = vec_mad(out->faces, -in->n_faces, limit);
    for (int k = 0; k < 2; k++)
        out->end[k] = vec_sub(out->end[k], limit);
    for (int j = 0; j < 5; j++)
        for (int i = 0; i < 5; i++)
            out->grid[j][i] = vec_sub(out->grid[j][i], limit);
    out->ring.centre = vec_sub(out->ring.centre, limit);
    for (uint32_t k = 0; k < ring_edges(&out->ring); k++)
        out->ring.edge[k] = vec_sub(out->ring.edge[k], limit);
    for (uint32_t k = 0; k < out->ring.n_faces; k++)
        out->ring.face[k] = vec_sub(out->ring.face[k], limit);
}

/* Writes the rotation whose columns are the axes as a unit quaternion (Shepperd 1978). */
static void write_frame(const struct vec axis[3], float texel[4])
{
    const double m[3][3] = {{axis[0].x, axis[1].x, axis[2].x},
                            {axis[0].y, axis[1].y, axis[2].y},
                            {axis[0].z, axis[1].z, axis[2].z}};
    double trace = m[0][0] + m[1][1] + m[2][2], r[4];
    int i = m[1][1] > m[0][0] ? 1 : 0;
    i = m[2][2] > m[i][i] ? 2 : i;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    if (trace > m[i][i]) {
        r[3] = 1 + trace;
        r[0] = m[2][1] - m[1][2];
        r[1] = m[0][2] - m[2][0];
        r[2] = m[1][0] - m[0][1];
    } else {
        r[i] = 1 + m[i][i] - m[j][j] - m[k][k];
        r[j] = m[i][j] + m[j][i];
        r[k] = m[i][k] + m[k][i];
        r[3] = m[k][j] - m[j][k];
    }
    double length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int n = 0; n < 4; n++)
        texel[n] = (float)(r[n] / length);
}

/* The vertex's frame (server/surface/README.md 3.3): axis[2] is the normal, if there is one.
 * Returns whether there is. */
static bool vertex_frame(const struct ring *ring, const struct dart_mask_list *known,
                         struct dart_masks *masks, struct vec axis[3], struct arena *arena)
{
    struct vec t1, t2;
    bool has_normal = ring_tangents(ring, &t1, &t2);
    if (ring_is_dart(ring)) {
        dart_mask_list_find(known, ring, arena, masks);
        t1 = dart_mask_apply(masks->tangent[0], ring);
        t2 = dart_mask_apply(masks->tangent[1], ring);
    }
    return ring_frame(ring, t1, t2, axis) && has_normal;
}

static void find_vertex_limit(struct vertex_limit *vertex, const struct ring *ring,
                              const struct dart_mask_list *known, struct arena *arena)
{
    vertex->has_normal = vertex_frame(ring, known, &vertex->masks, vertex->axis, arena);
    vertex->limit = limit_position(ring, &vertex->masks);
    vertex->edges = vertex->faces = (struct vec){0, 0, 0};
    for (uint32_t k = 0; ring->closed && needs_window(ring) && k < ring->n_faces; k++) {
        vertex->edges =
            vec_add(vertex->edges, to_frame(ring->edge[k], vertex->limit, vertex->axis));
        vertex->faces =
            vec_add(vertex->faces, to_frame(ring->face[k], vertex->limit, vertex->axis));
    }
    vertex->is_known = true;
}

/* At a vertex without a single normal each quad has its own frame, by its corner of the net at this
 * level. A lower level would cost digits in the last levels, where single precision has fewest to
 * spare; a higher one would cost digits in the levels before. */
enum { FRAME_LEVEL = 28 };

/* axis[2] becomes the normal of that corner, axis[0] its slowest direction, the sum of its edges.
 * Deep levels of a cone, or of a sector of many quads, are much longer in that direction than
 * across it. If it is an axis, the short coordinates keep their own digits. On entry `axis` is the
 * vertex's frame, in which net[0] is given. */
static void own_frame(struct net net[2], const struct dart_masks *masks, struct vec axis[3])
{
    for (unsigned n = 0; n < FRAME_LEVEL; n++)
        next_net(&net[n & 1], masks, &net[(n + 1) & 1]);
    const struct ring *ring = &net[FRAME_LEVEL & 1].ring;
    struct vec a = ring_edge(ring, 0), b = ring_edge(ring, 1), turned[3], out[3];
    ring_frame(ring, vec_add(a, b), b, turned);
    for (int k = 0; k < 3; k++) {
        out[k] = vec_scale(axis[0], turned[k].x);
        out[k] = vec_mad(vec_mad(out[k], turned[k].y, axis[1]), turned[k].z, axis[2]);
    }
    memcpy(axis, out, sizeof out);
}

unsigned corner_levels(const struct ring *ring)
{
    const double pixel = 0x1p-24, pi = 3.14159265358979323846;
    /* A dart's ring counts as a sector that begins and ends at the sharp edge. */
    bool is_whole = ring->closed && !ring->creases.edge;
    /* If the vertex of a whole ring is fixed by its sharpness or by an outside crease, all points
     * of the ring approach it alike: a wave of angle 0. */
    bool is_tip = is_whole && (ring->sharpness > 0 || ring_has_outside_crease(ring));
    double angle = is_tip ? 0 : (is_whole ? 2 : 1) * pi / ring->n_faces;
    double eigenvalue = fmax(ring_eigenvalue(angle), 0.5);
    double levels = ceil(log(pixel) / log(eigenvalue)) + 2;
    return (unsigned)fmin(fmax(levels, LIMIT_MIN_LEVELS), LIMIT_MAX_LEVELS);
}

/* Weighed bounds take more time than the levels themselves. They matter for levels that are larger
 * than pixels: the first ones. */
enum { WEIGHED_LEVELS = 6 };

void corner_begin(struct corner_nets *nets, const struct quad *quad,
                  const struct dart_mask_list *known, struct arena *arena)
{
    const struct ring *ring = &quad->corner[0];
    struct vertex_limit *vertex = ring_cache_vertex(ring);
    if (!vertex) {
        vertex = &nets->own;
        vertex->is_known = false;
    }
    if (!vertex->is_known)
        find_vertex_limit(vertex, ring, known, arena);
    nets->vertex = vertex;
    nets->level = 0;
    struct net *net = nets->net;
    for (int k = 0; k < 2; k++) {
        net[k] = (struct net){0};
        net[k].ring = needs_window(ring)
                          ? ring_take(arena, WINDOW, false, false)
                          : ring_take(arena, ring->n_faces, ring->closed, ring->creases.edge);
        nets->axis[k] = vertex->axis[k];
    }
    nets->axis[2] = vertex->axis[2];
    first_net(quad, vertex, nets->axis, &net[0]);
    if (!ring_has_one_normal(ring)) {
        own_frame(net, &vertex->masks, nets->axis);
        first_net(quad, vertex, nets->axis, &net[0]);
    }
}

const struct vec *corner_next_level(struct corner_nets *nets)
{
    struct net *net = nets->net;
    unsigned n = nets->level++;
    next_net(&net[n & 1], &nets->vertex->masks, &net[(n + 1) & 1]);
    return (const struct vec *)(const void *)net[(n + 1) & 1].grid;
}

struct limit_bound corner_level_bound(const struct vec grid[25], unsigned level)
{
    return bound_of_grid(grid, 5, true, level <= WEIGHED_LEVELS);
}

void corner_write_head(const struct corner_nets *nets, float frame[4], double origin[3])
{
    write_frame(nets->axis, frame);
    origin[0] = nets->vertex->limit.x;
    origin[1] = nets->vertex->limit.y;
    origin[2] = nets->vertex->limit.z;
}

void corner_write_levels(struct corner_nets *nets, unsigned levels, float (*texels)[4],
                         struct limit_bound *bounds)
{
    write_frame(nets->axis, texels[0]);
    float *scales = texels[1];
    memset(scales, 0, (LIMIT_CORNER_HEAD(levels) - 1) * sizeof *texels);
    texels += LIMIT_CORNER_HEAD(levels);
    for (unsigned n = 0; n < levels; n++) {
        const struct vec *grid = corner_next_level(nets);
        scales[n] = texels_write_level(grid, texels + n * LIMIT_LEVEL_TEXELS);
        bounds[n] = corner_level_bound(grid, n + 1);
    }
}
