#include "server/surface/subdivision/face.h"

#include <string.h>

#include "server/surface/subdivision/adjacency.h"
#include "server/surface/bound.h"
#include "server/surface/regular.h"
#include "server/surface/subdivision/corner.h"
#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/settle.h"
#include "server/surface/subdivision/dart_masks.h"
#include "server/surface/subdivision/strip.h"
#include "server/surface/texels.h"

/* Builds a REGULAR node of 16 control points; while measuring, only counts it. */
static void build_patch(struct face_builder *b, uint32_t node, struct vec grid[4][4])
{
    if (b->tables)
        regular_write(b->tables, node, &grid[0][0], b->next.texel);
    b->next.texel += LIMIT_PATCH_TEXELS;
    b->count[LIMIT_REGULAR]++;
}

static void build_regular(struct face_builder *b, uint32_t node, const struct quad *quad)
{
    struct vec grid[4][4];
    if (b->tables)
        quad_grid(quad, grid);
    build_patch(b, node, grid);
}

/* True if the surface about a settled ring bends like its net: no crease, boundary or sharp vertex,
 * of this sheet or of others, shapes it. */
static bool bends_as_net(const struct ring *ring)
{
    return ring->closed && !ring->creases.edge && ring->sharpness <= 0 &&
           !ring_has_outside_crease(ring);
}

/* Writes the corner as a whole, from its vertex's limit position. `first` is the bound of its first
 * level, whose parameters change twice as fast; NULL: the net tells how the surface bends. */
static void write_corner_whole(struct face_builder *b, uint32_t node, const struct quad *quad,
                               struct vec origin, const struct limit_bound *first)
{
    struct vec grid[16];
    const struct ring *ring = &quad->corner[0];
    quad_grid(quad, (struct vec(*)[4])grid);
    for (int k = 0; k < 16; k++)
        grid[k] = vec_sub(grid[k], origin);
    struct limit_bound bound = bound_of_grid(grid, 4, true, true);
    double reach = (double)bound.radius;
    for (uint32_t k = 0; k < ring_edges(ring); k++)
        reach = fmax(reach, 1.000001 * vec_length(vec_sub(ring->edge[k], origin)));
    for (uint32_t k = 0; k < ring->n_faces; k++)
        reach = fmax(reach, 1.000001 * vec_length(vec_sub(ring->face[k], origin)));
    if (first)
        bound = (struct limit_bound){.u = 4 * first->u,
                                     .mixed = 4 * first->mixed,
                                     .v = 4 * first->v,
                                     .border_u = 4 * first->border_u,
                                     .border_v = 4 * first->border_v};
    bound.radius = (float)(reach * 1.000001);
    b->tables->whole[node] = bound;
    struct limit_head *head = &b->tables->heads[node];
    regular_write_corner(head, 0, (struct vec){0, 0, 0});
    for (int k = 1; k < 4; k++)
        regular_write_corner(head, k, regular_corner_point(grid, k & 1 ? 2 : 1, k < 2 ? 1 : 2));
}

static void build_corner(struct face_builder *b, uint32_t node, const struct quad *quad,
                         unsigned corner)
{
    const struct ring *ring = &quad->corner[corner];
    unsigned levels = corner_levels(ring);
    if (ring_is_dart(ring) && ring->n_faces > DART_MAX_VALENCE) {
        b->dart_valence = ring->n_faces;
    } else if (!b->tables) {
        if (ring_is_dart(ring))
            dart_mask_list_add(b->darts, ring, &b->arena);
    } else {
        struct limit_node *out = &b->tables->nodes[node];
        struct quad turned = quad_rotated(quad, corner);
        struct corner_nets *nets = &b->nets;
        out->kind = LIMIT_CORNER;
        out->rotation = (uint8_t)corner;
        out->first = b->next.texel;
        corner_begin(nets, &turned, b->plan->darts, &b->arena);
        out->levels = (uint8_t)(nets->vertex->has_normal ? levels : levels | LIMIT_NO_NORMAL);
        corner_write_head(nets, b->tables->heads[node].frame, out->origin);
        struct limit_bound first;
        bool by_net = bends_as_net(&turned.corner[0]);
        if (b->tables->texels) {
            corner_write_levels(nets, levels, b->tables->texels + b->next.texel,
                                b->tables->bounds + b->next.bound);
            first = b->tables->bounds[b->next.bound];
        } else if (!by_net) {
            first = corner_level_bound(corner_next_level(nets), 1);
        }
        write_corner_whole(b, node, &turned, nets->vertex->limit, by_net ? NULL : &first);
    }
    b->next.texel += LIMIT_CORNER_TEXELS(levels);
    b->next.bound += levels;
    b->count[LIMIT_CORNER]++;
}

static void build_strip(struct face_builder *b, uint32_t node, const struct quad *quad,
                        unsigned edge, unsigned levels)
{
    if (b->tables) {
        struct limit_node *out = &b->tables->nodes[node];
        struct quad turned = quad_rotated(quad, edge);
        struct vec whole[16], patch[STRIP_MAX_LEVELS + 1][16];
        out->kind = LIMIT_STRIP;
        out->rotation = (uint8_t)edge;
        out->levels = (uint8_t)levels;
        out->first = b->next.texel;
        strip_points(&turned, levels, whole, patch, out->origin);
        b->tables->whole[node] = bound_of_grid(whole, 4, false, true);
        regular_write_head(b->tables, node, patch[levels], patch[0]);
        for (unsigned n = 0; n <= levels && b->tables->texels; n++) {
            texels_write_patch(patch[n],
                               b->tables->texels + b->next.texel + n * LIMIT_PATCH_TEXELS);
            b->tables->bounds[b->next.bound + n] = bound_of_grid(patch[n], 4, false, true);
        }
    }
    b->next.texel += (levels + 1) * LIMIT_PATCH_TEXELS;
    b->next.bound += levels + 1;
    b->count[LIMIT_STRIP]++;
}

static void build_node(struct face_builder *b, uint32_t node, const struct quad *quad);

/* Builds four children; their quads are in the parent's orientation. */
static void build_split(struct face_builder *b, uint32_t node, const struct quad child[4])
{
    uint32_t first = b->next.node;
    b->next.node += 4;
    b->count[LIMIT_SPLIT]++;
    if (b->tables) {
        struct limit_node *parent = &b->tables->nodes[node], *nodes = b->tables->nodes;
        parent->kind = LIMIT_SPLIT;
        parent->first = first;
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t x = 2 * (parent->cell & 0xffff) + (i == 1 || i == 2);
            uint32_t y = 2 * (parent->cell >> 16) + (i >= 2);
            nodes[first + i].face = parent->face;
            nodes[first + i].depth = (uint8_t)(parent->depth + 1);
            nodes[first + i].cell = x | y << 16;
            nodes[first + i].borders = parent->borders;
        }
    }
    for (uint32_t i = 0; i < 4; i++)
        build_node(b, first + i, &child[i]);
}

static void extend_box(struct face_builder *b, struct vec p)
{
    const double at[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        b->box_min[k] = fmin(b->box_min[k], at[k]);
        b->box_max[k] = fmax(b->box_max[k], at[k]);
    }
}

/* While measuring, extends the box by the limit positions of a leaf's corners, and by the middle of
 * a regular patch, where the surface of a coarse cage bulges most. */
static void measure_extent(struct face_builder *b, const struct quad *quad)
{
    if (b->tables)
        return;
    struct vec grid[4][4], middle = {0, 0, 0};
    for (unsigned i = 0; i < 4; i++)
        if (!ring_is_dart(&quad->corner[i]))
            extend_box(b, ring_cache_limit(&quad->corner[i]));
    if (quad_extraordinary(quad))
        return;
    static const double weight[4] = {1.0 / 48, 23.0 / 48, 23.0 / 48, 1.0 / 48};
    quad_grid(quad, grid);
    for (int k = 0; k < 16; k++)
        middle = vec_mad(middle, weight[k / 4] * weight[k % 4], grid[k / 4][k % 4]);
    extend_box(b, middle);
}

/* A quad becomes a leaf if its rules do not change any more and at most one of its corners is
 * extraordinary, or if it lies along a plain semi-sharp crease; otherwise it is split. Sharpness
 * below 10 is gone after 10 steps, and one more step separates extraordinary corners, so the depth
 * is bounded. */
static void build_node(struct face_builder *b, uint32_t node, const struct quad *quad)
{
    size_t mark = b->arena.used;
    unsigned extraordinary = quad_extraordinary(quad), edge = 0;
    bool semisharp = quad_is_semisharp(quad);
    unsigned levels = semisharp ? strip_levels(quad, &edge) : 0;
    if (b->tables)
        b->tables->whole[node].radius = -1;
    if (b->tables && b->tables->texels)
        b->tables->bound_first[node] = b->next.bound;
    bool is_strip = levels > 0 && levels <= STRIP_MAX_LEVELS;
    bool is_split = !is_strip && (semisharp || extraordinary & (extraordinary - 1));
    if (!is_split && !semisharp)
        measure_extent(b, quad);
    if (is_strip) {
        build_strip(b, node, quad, edge, levels);
    } else if (is_split) {
        struct quad child[4];
        quad_refine(quad, &b->arena, child);
        build_split(b, node, child);
    } else if (extraordinary) {
        build_corner(b, node, quad, (unsigned)__builtin_ctz(extraordinary));
    } else {
        build_regular(b, node, quad);
    }
    b->arena.used = mark;
}

/* Builds a face whose four vertices are interior and regular, like most: its points need no
 * ring. */
static void build_plain(struct face_builder *b, uint32_t ptex, uint32_t c)
{
    struct vec grid[4][4];
    if (b->tables) {
        extract_plain_grid(&b->plan->topology, c, grid);
    } else {
        /* A camera frames the box: the cage's corners are near enough for that. */
        const struct cage *cage = b->plan->cage;
        for (unsigned i = 0; i < 4; i++) {
            const double *p = cage->position[cage->face_vertex[c + i]];
            extend_box(b, (struct vec){p[0], p[1], p[2]});
        }
    }
    build_patch(b, ptex, grid);
}

/* The value in limit_node.borders for half-edge c of a cage face. */
static unsigned border_of(const struct limit_plan *plan, uint32_t c)
{
    const struct topology *t = &plan->topology;
    float sharpness = edge_sharpness(t, c);
    if (sharpness >= CAGE_SHARPNESS_INFINITE || (plan->hole && plan->hole[t->face[t->twin[c]]]))
        return LIMIT_BORDER_SHARP;
    return (unsigned)ceilf(fmaxf(sharpness, 0));
}

/* The borders of the Ptex face at cage corner c. A Ptex face of an n-gon is bordered by halves of
 * two cage edges, on which creases take one level less. */
static uint16_t borders_of(const struct limit_plan *plan, uint32_t c)
{
    const struct topology *t = &plan->topology;
    unsigned bits = 0;
    if (face_size(t, t->face[c]) != 4) {
        unsigned first = border_of(plan, c), last = border_of(plan, corner_prev(t, c));
        first -= first > 0 && first < LIMIT_BORDER_SHARP;
        last -= last > 0 && last < LIMIT_BORDER_SHARP;
        return (uint16_t)(first | last << 12);
    }
    for (unsigned e = 0; e < 4; e++, c = corner_next(t, c))
        bits |= border_of(plan, c) << 4 * e;
    return (uint16_t)bits;
}

static void start_root(struct face_builder *b, uint32_t ptex)
{
    const struct topology *t = &b->plan->topology;
    uint32_t c = b->plan->corner[ptex], size = face_size(t, t->face[c]);
    struct limit_node *root = &b->tables->nodes[ptex];
    root->face = ptex;
    root->kind = LIMIT_HOLE;
    root->ngon_size = size == 4 ? 0 : size;
    root->ngon_corner = (uint16_t)(size == 4 ? 0 : c - t->cage->face_start[t->face[c]]);
    root->borders = borders_of(b->plan, c);
    b->tables->whole[ptex].radius = -1;
    if (b->tables->texels)
        b->tables->bound_first[ptex] = b->next.bound;
    b->tables->adjacency[ptex] = adjacency_of(b->plan, ptex);
}

static bool touches_ngon(const struct topology *t, uint32_t c)
{
    for (unsigned i = 0; i < 4; i++, c = corner_next(t, c))
        if (t->vertex_flags[corner_vertex(t, c)] & VERTEX_BY_NGON)
            return true;
    return false;
}

bool face_quads(const struct limit_plan *plan, uint32_t ptex, struct ring_cache *rings,
                struct arena *arena, struct quad quad[4])
{
    const struct topology *t = &plan->topology;
    uint32_t c = plan->corner[ptex];
    if (face_size(t, t->face[c]) != 4) {
        quad[0] = extract_refined_quad(t, &plan->refined, c, rings, arena);
        return false;
    }
    if (!plan->refined.face || !touches_ngon(t, c)) {
        quad[0] = extract_quad(t, c, rings, arena);
        return false;
    }
    for (unsigned i = 0; i < 4; i++, c = corner_next(t, c)) {
        struct quad own = extract_refined_quad(t, &plan->refined, c, rings, arena);
        quad[i] = quad_rotated(&own, (4 - i) & 3);
    }
    return true;
}

void face_build(struct face_builder *b, uint32_t ptex)
{
    const struct limit_plan *plan = b->plan;
    const struct topology *t = &plan->topology;
    uint32_t c = plan->corner[ptex], face = t->face[c];
    b->arena.used = 0;
    if (b->tables)
        start_root(b, ptex);
    if (plan->hole && plan->hole[face]) {
        b->count[LIMIT_HOLE]++;
        return;
    }
    if (face_size(t, face) == 4 && quad_is_plain(t, c)) {
        build_plain(b, ptex, c);
        return;
    }
    struct quad quad[4];
    if (face_quads(plan, ptex, &b->rings, &b->arena, quad))
        build_split(b, ptex, quad);
    else
        build_node(b, ptex, &quad[0]);
}
