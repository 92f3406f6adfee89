#include "server/surface/spline/build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/cage/joints.h"
#include "server/surface/bound.h"
#include "server/surface/regular.h"
#include "server/surface/source.h"
#include "server/surface/spline/joint.h"
#include "server/surface/texels.h"

enum { FACES_PER_QUESTION = 64 }; /* the watch is asked once for so many faces */

/* What the plan keeps of a patch. */
struct spline_face {
    struct vec grid[16]; /* B-spline points */
    struct limit_adjacency adjacency;
    uint16_t borders;
    uint8_t bends; /* as in limit_tables */
};

struct spline_plan {
    struct limit_source source; /* must be the first member */
    unsigned n_users;           /* the caller, and tables on demand that use it */
    struct limit_size size;
    struct spline_face *face; /* [size.n_faces] */
};

static void keep(struct limit_source *source)
{
    struct spline_plan *plan = (struct spline_plan *)(void *)source;
    __atomic_fetch_add(&plan->n_users, 1, __ATOMIC_RELAXED);
}

static void drop(struct limit_source *source)
{
    struct spline_plan *plan = (struct spline_plan *)(void *)source;
    if (__atomic_sub_fetch(&plan->n_users, 1, __ATOMIC_ACQ_REL) > 0)
        return;
    free(plan->face);
    free(plan);
}

/* The make() of limit_source. */
static void make(struct limit_source *source, const struct limit_tables *tables, uint32_t node,
                 unsigned n, struct limit_level *level, struct limit_bound *bound)
{
    const struct spline_plan *plan = (const struct spline_plan *)(const void *)source;
    struct vec grid[16];
    (void)tables;
    (void)n;
    memcpy(grid, plan->face[node].grid, sizeof grid);
    regular_centre(grid);
    if (bound)
        *bound = bound_of_grid(grid, 4, false, true);
    if (level) {
        texels_write_patch(grid, level->texels);
        memcpy(level->points, grid, sizeof grid);
    }
}

/* --- measuring */

static void extend(double low[3], double high[3], const double p[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(low[k], p[k]);
        high[k] = fmax(high[k], p[k]);
    }
}

/* A point of the surface, at thirds of the parameters. */
static void point_at(double bezier[16][3], int x, int y, double out[3])
{
    static const double weight[4][4] = {{1, 0, 0, 0},
                                        {8 / 27.0, 12 / 27.0, 6 / 27.0, 1 / 27.0},
                                        {1 / 27.0, 6 / 27.0, 12 / 27.0, 8 / 27.0},
                                        {0, 0, 0, 1}};
    for (int k = 0; k < 3; k++)
        out[k] = 0;
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 3; k++)
            out[k] += weight[x][i & 3] * weight[y][i >> 2] * bezier[i][k];
}

/* The points of a Bezier net contain the surface, and 16 points of the surface tell what a camera frames. */
static void extend_boxes(struct limit_size *size, double bezier[16][3])
{
    double p[3];
    for (int i = 0; i < 16; i++) {
        extend(size->hull_min, size->hull_max, bezier[i]);
        point_at(bezier, i & 3, i >> 2, p);
        extend(size->box_min, size->box_max, p);
    }
}

static void set_points(struct spline_face *face, const struct cage_patch *patch)
{
    double grid[16][3];
    cage_patch_bspline(patch, grid);
    for (int k = 0; k < 16; k++)
        face->grid[k] = (struct vec){grid[k][0], grid[k][1], grid[k][2]};
}

/* A collapsed edge is no border: the surface goes on around it. */
static void set_edges(struct spline_plan *plan, const struct cage *cage,
                      const struct cage_joints *joints, uint32_t f, double bezier[16][3])
{
    struct spline_face *face = &plan->face[f];
    for (unsigned e = 0; e < 4; e++) {
        const uint32_t other = joints->across[f][e];
        enum joint_kind kind = joints->collapsed[f] >> e & 1 ? JOINT_SMOOTH : JOINT_CREASE;
        face->adjacency.across[e] = other == CAGE_NO_PATCH ? LIMIT_NO_FACE : other;
        if (other != CAGE_NO_PATCH) {
            double beyond[16][3];
            cage_patch_bezier(&cage->patch[other >> 2], beyond);
            kind = joint_kind_of(bezier, e, beyond, other & 3);
        }
        face->borders |= (uint16_t)((kind == JOINT_CREASE ? LIMIT_BORDER_SHARP : 0u) << 4 * e);
        face->bends |= (uint8_t)((kind == JOINT_BEND) << e);
    }
}

static bool measure(struct spline_plan *plan, const struct cage *cage,
                    const struct cage_joints *joints, const struct limit_watch *watch,
                    struct error *error)
{
    for (uint32_t f = 0; f < cage->n_patches; f++) {
        double bezier[16][3];
        if (f % FACES_PER_QUESTION == 0 && !limit_goes_on(watch, error))
            return false;
        cage_patch_bezier(&cage->patch[f], bezier);
        set_points(&plan->face[f], &cage->patch[f]);
        set_edges(plan, cage, joints, f, bezier);
        extend_boxes(&plan->size, bezier);
        plan->size.has_bends |= plan->face[f].bends != 0;
    }
    return true;
}

struct spline_plan *spline_plan_create(const struct cage *cage, const struct limit_watch *watch,
                                       struct error *error)
{
    struct limit_size size = {.n_faces = cage->n_patches,
                              .n_nodes = cage->n_patches,
                              .n_texels = cage->n_patches * LIMIT_PATCH_TEXELS,
                              .count = {[LIMIT_REGULAR] = cage->n_patches},
                              .plan_bytes = cage->n_patches *
                                                (sizeof *cage->patch + sizeof(struct spline_face)) +
                                            cage_joints_bytes(cage->n_patches)};
    struct cage_joints joints = {0};
    struct spline_plan *plan = NULL;
    if (!limit_may_need(watch, &size, error))
        return NULL;
    bool has_memory = (plan = calloc(1, sizeof *plan)) &&
                      (plan->face = calloc(cage->n_patches, sizeof *plan->face)) &&
                      cage_joints_find(&joints, cage);
    for (int k = 0; k < 3; k++) {
        size.box_min[k] = size.hull_min[k] = INFINITY;
        size.box_max[k] = size.hull_max[k] = -INFINITY;
    }
    if (plan) {
        plan->n_users = 1;
        plan->source = (struct limit_source){keep, drop, make,
                                             sizeof *plan + cage->n_patches * sizeof *plan->face};
        size.source = &plan->source;
        plan->size = size;
    }
    bool ok = has_memory ? measure(plan, cage, &joints, watch, error)
                         : error_set(error, ERROR_SERVER,
                                     "out of memory for the plan of %zu patches", cage->n_patches);
    cage_joints_finish(&joints);
    if (ok)
        return plan;
    spline_plan_destroy(plan);
    return NULL;
}

void spline_plan_destroy(struct spline_plan *plan)
{
    if (plan)
        drop(&plan->source);
}

const struct limit_size *spline_plan_size(const struct spline_plan *plan)
{
    return &plan->size;
}

/* --- filling */

static void build_face(struct limit_tables *tables, const struct spline_face *face, uint32_t f)
{
    struct limit_node *root = &tables->nodes[f];
    struct vec grid[16];
    memcpy(grid, face->grid, sizeof grid);
    root->face = f;
    root->borders = face->borders;
    tables->adjacency[f] = face->adjacency;
    if (tables->bends)
        tables->bends[f] = face->bends;
    if (tables->bound_first)
        tables->bound_first[f] = 0;
    regular_write(tables, f, grid, f * LIMIT_PATCH_TEXELS);
}

bool spline_build_faces(struct limit_tables *tables, const struct spline_plan *plan, size_t first,
                        size_t last, const struct limit_watch *watch, struct error *error)
{
    for (size_t f = first; f < last; f++) {
        if (f % FACES_PER_QUESTION == 0 && !limit_goes_on(watch, error))
            return false;
        build_face(tables, &plan->face[f], (uint32_t)f);
    }
    return true;
}
