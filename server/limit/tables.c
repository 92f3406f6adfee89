#include "server/limit/tables.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "server/limit/adjacency.h"
#include "server/limit/bound.h"
#include "server/limit/corner.h"
#include "server/limit/plan.h"
#include "server/limit/texels.h"

static_assert(sizeof(struct limit_node) == 48, "three RGBA32UI texels");
static_assert(sizeof(struct limit_adjacency) == 16, "one RGBA32UI texel");

/* Where the next node, point and bound of the face being built go. */
struct builder {
    struct limit_tables *tables;
    const struct limit_plan *plan;
    struct plan_offsets next;
    struct arena arena;
};

static void bounding_box(const struct cage *cage, double box_min[3], double box_max[3])
{
    for (int k = 0; k < 3; k++) {
        box_min[k] = INFINITY;
        box_max[k] = -INFINITY;
    }
    for (size_t c = 0; c < cage->face_start[cage->n_faces]; c++) {
        const double *p = cage->position[cage->face_vertex[c]];
        for (int k = 0; k < 3; k++) {
            box_min[k] = fmin(box_min[k], p[k]);
            box_max[k] = fmax(box_max[k], p[k]);
        }
    }
}

bool limit_tables_init(struct limit_tables *tables, const struct limit_plan *plan,
                       struct error *error)
{
    struct plan_offsets total = plan->offsets[plan->n_ptex];
    *tables = (struct limit_tables){.n_faces = plan->n_ptex,
                                    .n_nodes = total.node,
                                    .n_points = total.point,
                                    .n_bounds = total.bound};
    tables->nodes = calloc(tables->n_nodes, sizeof *tables->nodes);
    tables->adjacency = malloc(tables->n_faces * sizeof *tables->adjacency);
    tables->points = malloc((tables->n_points + 1) * sizeof *tables->points);
    tables->bound_first = malloc(tables->n_nodes * sizeof *tables->bound_first);
    tables->bounds = malloc((tables->n_bounds + 1) * sizeof *tables->bounds);
    if (!tables->nodes || !tables->adjacency || !tables->points || !tables->bound_first ||
        !tables->bounds) {
        size_t bytes = limit_tables_bytes(tables);
        limit_tables_finish(tables);
        return error_set(error, ERROR_SERVER, "out of memory: the tables need %zu bytes", bytes);
    }
    bounding_box(plan->cage, tables->box_min, tables->box_max);
    for (uint32_t p = 0; p < plan->n_ptex; p++) {
        struct plan_shape shape = plan_shape_of(plan, p);
        unsigned corners = (unsigned)__builtin_popcount(shape.extraordinary);
        unsigned leaves = shape.root == LIMIT_HOLE ? 0 : shape.root == LIMIT_SPLIT ? 4 : 1;
        tables->n_hole += shape.root == LIMIT_HOLE;
        tables->n_split += shape.root == LIMIT_SPLIT;
        tables->n_corner += leaves ? corners : 0;
        tables->n_regular += leaves ? leaves - corners : 0;
    }
    return true;
}

void limit_tables_finish(struct limit_tables *tables)
{
    free(tables->nodes);
    free(tables->adjacency);
    free(tables->points);
    free(tables->bound_first);
    free(tables->bounds);
    *tables = (struct limit_tables){0};
}

size_t limit_tables_bytes(const struct limit_tables *tables)
{
    return tables->n_nodes * sizeof *tables->nodes + tables->n_faces * sizeof *tables->adjacency +
           tables->n_points * sizeof *tables->points;
}

static void build_regular(struct builder *b, uint32_t node, const struct quad *quad)
{
    struct limit_node *out = &b->tables->nodes[node];
    struct vec grid[4][4], centre = {0, 0, 0};
    quad_grid(quad, grid);
    for (int k = 0; k < 16; k++)
        centre = vec_mad(centre, 1.0 / 16, grid[k / 4][k % 4]);
    for (int k = 0; k < 16; k++)
        grid[k / 4][k % 4] = vec_sub(grid[k / 4][k % 4], centre);
    out->kind = LIMIT_REGULAR;
    out->origin[0] = centre.x;
    out->origin[1] = centre.y;
    out->origin[2] = centre.z;
    out->first = b->next.point;
    texels_write(&grid[0][0], 16, b->tables->points + b->next.point);
    b->tables->bounds[b->next.bound] = bound_of_grid(&grid[0][0], 4, false);
    b->next.point += LIMIT_REGULAR_POINTS;
    b->next.bound += 1;
}

static void build_corner(struct builder *b, uint32_t node, const struct quad *quad, unsigned corner)
{
    struct limit_node *out = &b->tables->nodes[node];
    struct quad turned = quad_rotated(quad, corner);
    out->kind = LIMIT_CORNER;
    out->rotation = (uint8_t)corner;
    out->first = b->next.point;
    corner_table(&turned, &b->arena, b->tables->points + b->next.point,
                 b->tables->bounds + b->next.bound, out->origin);
    b->next.point += LIMIT_CORNER_TEXELS;
    b->next.bound += LIMIT_LEVELS;
}

/* A quad with at most one extraordinary vertex. */
static void build_leaf(struct builder *b, uint32_t node, const struct quad *quad)
{
    unsigned extraordinary = quad_extraordinary(quad);
    b->tables->bound_first[node] = b->next.bound;
    if (extraordinary)
        build_corner(b, node, quad, (unsigned)__builtin_ctz(extraordinary));
    else
        build_regular(b, node, quad);
}

/* Four children, whose quads are given in the parent's orientation. */
static void build_split(struct builder *b, uint32_t node, const struct quad child[4])
{
    uint32_t first = b->next.node;
    b->tables->nodes[node].kind = LIMIT_SPLIT;
    b->tables->nodes[node].first = first;
    b->tables->bound_first[node] = b->next.bound;
    b->next.node += 4;
    for (uint32_t i = 0; i < 4; i++) {
        b->tables->nodes[first + i].face = b->tables->nodes[node].face;
        b->tables->nodes[first + i].depth = 1;
        b->tables->nodes[first + i].cell = (i == 1 || i == 2) | (uint32_t)(i >= 2) << 16;
        build_leaf(b, first + i, &child[i]);
    }
}

static void build_face(struct builder *b, uint32_t ptex)
{
    const struct limit_plan *plan = b->plan;
    const struct topology *t = &plan->topology;
    struct plan_shape shape = plan_shape_of(plan, ptex);
    struct limit_node *root = &b->tables->nodes[ptex];
    uint32_t c = plan->corner[ptex], size = face_size(t, t->face[c]);
    root->face = ptex;
    root->kind = LIMIT_HOLE;
    root->ngon_size = size == 4 ? 0 : size;
    root->ngon_corner = size == 4 ? 0 : c - t->cage->face_start[t->face[c]];
    b->tables->bound_first[ptex] = b->next.bound;
    b->tables->adjacency[ptex] = adjacency_of(plan, ptex);
    if (shape.root == LIMIT_HOLE)
        return;

    struct quad quad, child[4];
    if (size == 4 && shape.refined) {
        for (unsigned i = 0; i < 4; i++, c = corner_next(t, c)) {
            quad = extract_refined_quad(t, &plan->refined, c, &b->arena);
            child[i] = quad_rotated(&quad, (4 - i) & 3);
        }
        build_split(b, ptex, child);
        return;
    }
    quad = shape.refined ? extract_refined_quad(t, &plan->refined, c, &b->arena)
                         : extract_quad(t, c, &b->arena);
    if (shape.root == LIMIT_SPLIT) {
        quad_refine(&quad, &b->arena, child);
        build_split(b, ptex, child);
    } else {
        build_leaf(b, ptex, &quad);
    }
}

bool limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan, size_t first,
                       size_t last, struct error *error)
{
    struct builder b = {.tables = tables, .plan = plan};
    if (!arena_init(&b.arena, plan->arena_points))
        return error_set(error, ERROR_SERVER, "out of memory while building tables");
    for (size_t p = first; p < last; p++) {
        b.next = plan->offsets[p];
        b.arena.used = 0;
        build_face(&b, (uint32_t)p);
        assert(b.next.node == plan->offsets[p + 1].node);
        assert(b.next.point == plan->offsets[p + 1].point);
    }
    arena_finish(&b.arena);
    return true;
}
