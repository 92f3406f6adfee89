#include "server/surface/subdivision/build.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/surface/subdivision/dart_masks.h"
#include "server/surface/subdivision/face.h"
#include "server/surface/subdivision/maker.h"
#include "server/surface/subdivision/plan.h"
#include "server/surface/texels.h"

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

/* May the tables of this cage be kept, however simple its faces are? Checked before any other work.
 * A face with a surface takes at least one node of 16 points. */
static bool may_need_least(const struct cage *cage, const struct limit_watch *watch,
                           struct error *error)
{
    struct limit_size least = {0};
    for (size_t f = 0; f < cage->n_faces; f++) {
        uint32_t size = cage->face_start[f + 1] - cage->face_start[f];
        least.n_faces += size == 4 ? 1 : size;
    }
    least.n_nodes = least.n_faces;
    if (cage->n_holes == 0 && cage->boundary != CAGE_BOUNDARY_NONE) {
        least.n_texels = least.n_faces * LIMIT_PATCH_TEXELS;
        least.count[LIMIT_REGULAR] = least.n_faces;
    }
    return limit_may_need(watch, &least, error);
}

/* Measures all faces: each face's share of the tables begins where that of the previous one
 * ends. */
static bool lay_out(struct limit_plan *plan, const struct limit_watch *watch, struct error *error)
{
    struct face_builder measure = {.plan = plan,
                                   .darts = &plan->darts,
                                   .box_min = {INFINITY, INFINITY, INFINITY},
                                   .box_max = {-INFINITY, -INFINITY, -INFINITY}};
    if (!arena_init(&measure.arena, plan->arena_bytes))
        return error_set(error, ERROR_SERVER, "out of memory while measuring tables");
    ring_cache_init(&measure.rings, plan->cage->face_start[plan->cage->n_faces]);
    uint64_t node = plan->n_ptex, texel = 0, bound = 0;
    bool ok = true;
    for (uint32_t p = 0; p < plan->n_ptex && ok && (ok = limit_goes_on(watch, error)); p++) {
        plan->offsets[p] = (struct plan_offsets){(uint32_t)node, (uint32_t)texel, (uint32_t)bound};
        measure.next = (struct plan_offsets){0, 0, 0};
        face_build(&measure, p);
        node += measure.next.node;
        texel += measure.next.texel;
        bound += measure.next.bound;
        if (measure.dart_valence)
            ok = error_set(error, ERROR_MODEL,
                           "a crease ends at a vertex of %u faces, more than the %d that sheen "
                           "evaluates",
                           measure.dart_valence, DART_MAX_VALENCE);
        else if (node > INT32_MAX || texel > UINT32_MAX)
            ok = error_set(error, ERROR_MODEL,
                           "the cage needs more than %u table texels: split it in parts",
                           UINT32_MAX);
        struct limit_size so_far = {
            .n_faces = plan->n_ptex, .n_nodes = node, .n_texels = texel, .n_bounds = bound};
        memcpy(so_far.count, measure.count, sizeof so_far.count);
        ok = ok && limit_may_need(watch, &so_far, error);
    }
    plan->offsets[plan->n_ptex] =
        (struct plan_offsets){(uint32_t)node, (uint32_t)texel, (uint32_t)bound};
    plan->size = (struct limit_size){
        .n_faces = plan->n_ptex, .n_nodes = node, .n_texels = texel, .n_bounds = bound};
    memcpy(plan->size.count, measure.count, sizeof plan->size.count);
    bounding_box(plan->cage, plan->size.hull_min, plan->size.hull_max);
    for (int k = 0; k < 3; k++) {
        /* The box of a cage without surface is the origin. */
        plan->size.box_min[k] = measure.box_min[k] <= measure.box_max[k] ? measure.box_min[k] : 0;
        plan->size.box_max[k] = measure.box_min[k] <= measure.box_max[k] ? measure.box_max[k] : 0;
    }
    ring_cache_finish(&measure.rings);
    arena_finish(&measure.arena);
    return ok;
}

static void keep(struct limit_source *source)
{
    struct limit_plan *plan = (struct limit_plan *)(void *)source;
    __atomic_fetch_add(&plan->n_users, 1, __ATOMIC_RELAXED);
}

static void drop(struct limit_source *source)
{
    struct limit_plan *plan = (struct limit_plan *)(void *)source;
    if (__atomic_sub_fetch(&plan->n_users, 1, __ATOMIC_ACQ_REL) > 0)
        return;
    maker_pool_destroy(plan->makers);
    plan_finish(plan);
    free(plan);
}

struct limit_plan *limit_plan_create(const struct cage *cage, const struct limit_watch *watch,
                                     struct error *error)
{
    struct limit_plan *plan = malloc(sizeof *plan);
    if (!plan) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    *plan = (struct limit_plan){.n_users = 1};
    if (may_need_least(cage, watch, error) && plan_init(plan, cage, watch, error) &&
        lay_out(plan, watch, error)) {
        plan->makers = maker_pool_create(plan);
        plan->source = (struct limit_source){keep, drop, maker_make, plan_bytes(plan)};
        plan->size.source = &plan->source;
        if (plan->makers)
            return plan;
        error_set(error, ERROR_SERVER, "out of memory while measuring tables");
    }
    limit_plan_destroy(plan);
    return NULL;
}

void limit_plan_destroy(struct limit_plan *plan)
{
    if (plan)
        drop((struct limit_source *)(void *)plan);
}

const struct limit_size *limit_plan_size(const struct limit_plan *plan)
{
    return &plan->size;
}

bool limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan, size_t first,
                       size_t last, const struct limit_watch *watch, struct error *error)
{
    struct face_builder builder = {.tables = tables, .plan = plan};
    if (!arena_init(&builder.arena, plan->arena_bytes))
        return error_set(error, ERROR_SERVER, "out of memory while building tables");
    ring_cache_init(&builder.rings, plan->cage->face_start[plan->cage->n_faces]);
    bool ok = true;
    for (size_t p = first; p < last && (ok = limit_goes_on(watch, error)); p++) {
        builder.next = plan->offsets[p];
        face_build(&builder, (uint32_t)p);
        assert(builder.next.node == plan->offsets[p + 1].node);
        assert(builder.next.texel == plan->offsets[p + 1].texel);
    }
    ring_cache_finish(&builder.rings);
    arena_finish(&builder.arena);
    return ok;
}
