#include "server/surface/subdivision/maker.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/surface/bound.h"
#include "server/surface/regular.h"
#include "server/surface/subdivision/face.h"
#include "server/surface/subdivision/strip.h"

enum {
    MOST_DEPTH = 12, /* largest depth of a tree of nodes (node.h) */
    /* After this many faces the rings of large vertices are dropped, because they would
     * accumulate. */
    FACES_PER_RING_CACHE = 4096,
};

/* The quads of a split node's children, or a root's own, and which of them is on the path. */
struct step {
    struct quad quad[4];
    unsigned child;
    size_t mark; /* the arena's mark behind them */
};

struct maker {
    struct maker *next; /* next unused maker */
    const struct limit_plan *plan;
    struct arena arena;
    struct ring_cache rings;
    uint32_t n_faces;
    uint32_t face, node;              /* UINT32_MAX: none */
    struct step step[MOST_DEPTH + 1]; /* [depth] */
    bool begins_split;                /* step[0] is not used */
    int n_steps;                      /* depth up to which the steps are valid */
    /* Of the node: */
    struct corner_nets nets;
    struct vec level[LIMIT_MAX_LEVELS][25];     /* CORNER: the levels up to nets.level */
    struct vec patch[STRIP_MAX_LEVELS + 1][16]; /* STRIP: its patches; REGULAR: one */
};

struct maker_pool {
    const struct limit_plan *plan;
    pthread_mutex_t mutex;
    pthread_cond_t given;
    struct maker *first;
};

static struct maker *create(const struct limit_plan *plan)
{
    struct maker *maker = calloc(1, sizeof *maker);
    if (!maker || !arena_init(&maker->arena, plan->arena_bytes)) {
        free(maker);
        return NULL;
    }
    maker->plan = plan;
    maker->face = maker->node = UINT32_MAX;
    ring_cache_init(&maker->rings, plan->cage->face_start[plan->cage->n_faces]);
    return maker;
}

static void destroy(struct maker *maker)
{
    ring_cache_finish(&maker->rings);
    arena_finish(&maker->arena);
    free(maker);
}

struct maker_pool *maker_pool_create(const struct limit_plan *plan)
{
    struct maker_pool *pool = calloc(1, sizeof *pool);
    if (pool)
        pool->first = create(plan);
    if (!pool || !pool->first) {
        free(pool);
        return NULL;
    }
    pool->plan = plan;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->given, NULL);
    return pool;
}

void maker_pool_destroy(struct maker_pool *pool)
{
    if (!pool)
        return;
    for (struct maker *maker = pool->first, *next; maker; maker = next) {
        next = maker->next;
        destroy(maker);
    }
    pthread_cond_destroy(&pool->given);
    pthread_mutex_destroy(&pool->mutex);
    free(pool);
}

/* The maker that is at that face, else any. Waits if all are in use and memory for another is
 * short. */
static struct maker *take(struct maker_pool *pool, uint32_t face)
{
    pthread_mutex_lock(&pool->mutex);
    while (!pool->first) {
        struct maker *maker = create(pool->plan);
        if (maker) {
            pthread_mutex_unlock(&pool->mutex);
            return maker;
        }
        pthread_cond_wait(&pool->given, &pool->mutex);
    }
    struct maker **at = &pool->first, **last = at;
    for (; *at && (*at)->face != face; at = &(*at)->next)
        last = at;
    at = *at ? at : last; /* the one unused for the longest time */
    struct maker *maker = *at;
    *at = maker->next;
    pthread_mutex_unlock(&pool->mutex);
    return maker;
}

static void give(struct maker_pool *pool, struct maker *maker)
{
    pthread_mutex_lock(&pool->mutex);
    maker->next = pool->first;
    pool->first = maker;
    pthread_cond_signal(&pool->given);
    pthread_mutex_unlock(&pool->mutex);
}

/* --- */

static void begin_face(struct maker *maker, uint32_t face)
{
    if (++maker->n_faces % FACES_PER_RING_CACHE == 0) {
        size_t n_corners = maker->rings.n_corners;
        ring_cache_finish(&maker->rings);
        ring_cache_init(&maker->rings, n_corners);
    }
    struct quad quad[4];
    maker->face = face;
    maker->arena.used = 0;
    maker->begins_split = face_quads(maker->plan, face, &maker->rings, &maker->arena, quad);
    maker->n_steps = maker->begins_split;
    struct step *step = &maker->step[maker->n_steps];
    memcpy(step->quad, quad, sizeof quad);
    step->mark = maker->arena.used;
    step->child = 0;
}

/* The child index, in its parent, of the node `levels` above this one. */
static unsigned child_at(const struct limit_node *node, unsigned levels)
{
    unsigned x = node->cell >> levels & 1, y = node->cell >> 16 >> levels & 1;
    return y ? 3 - x : x;
}

/* The quad of a node of maker->face. What lies in the arena behind its step is released. */
static const struct quad *quad_of(struct maker *maker, const struct limit_node *node)
{
    int depth = node->depth, first = maker->begins_split;
    bool is_known = true; /* the steps so far equal those of the previous node */
    for (int d = first; d <= depth; d++) {
        struct step *step = &maker->step[d];
        unsigned child = d > 0 ? child_at(node, (unsigned)(depth - d)) : 0;
        is_known = is_known && d <= maker->n_steps;
        if (!is_known) {
            const struct step *above = step - 1;
            maker->arena.used = above->mark;
            quad_refine(&above->quad[above->child], &maker->arena, step->quad);
            step->mark = maker->arena.used;
        }
        is_known = is_known && step->child == child;
        step->child = child;
    }
    maker->n_steps = depth;
    maker->arena.used = maker->step[depth].mark;
    return &maker->step[depth].quad[maker->step[depth].child];
}

static void begin_regular(struct maker *maker, const struct limit_node *node)
{
    const struct topology *t = &maker->plan->topology;
    uint32_t c = maker->plan->corner[node->face];
    struct vec grid[4][4];
    if (node->depth == 0 && face_size(t, t->face[c]) == 4 && quad_is_plain(t, c)) {
        extract_plain_grid(t, c, grid);
    } else {
        if (node->face != maker->face)
            begin_face(maker, node->face);
        quad_grid(quad_of(maker, node), grid);
    }
    memcpy(maker->patch[0], grid, sizeof grid);
    regular_centre(maker->patch[0]);
}

static void begin_node(struct maker *maker, const struct limit_node *node)
{
    if (node->kind == LIMIT_REGULAR) {
        begin_regular(maker, node);
        return;
    }
    if (node->face != maker->face)
        begin_face(maker, node->face);
    struct quad turned = quad_rotated(quad_of(maker, node), node->rotation);
    if (node->kind == LIMIT_CORNER) {
        corner_begin(&maker->nets, &turned, maker->plan->darts, &maker->arena);
    } else {
        struct vec whole[16];
        double origin[3];
        strip_points(&turned, node->levels, whole, maker->patch, origin);
    }
}

static const struct vec *level_of(struct maker *maker, unsigned n)
{
    for (unsigned k = maker->nets.level; k < n; k++)
        memcpy(maker->level[k], corner_next_level(&maker->nets), sizeof maker->level[k]);
    return maker->level[n - 1];
}

void maker_make(struct limit_source *source, const struct limit_tables *tables, uint32_t node,
                unsigned n, struct limit_level *level, struct limit_bound *bound)
{
    struct limit_plan *plan = (struct limit_plan *)(void *)source;
    const struct limit_node *of = &tables->nodes[node];
    struct maker *maker = take(plan->makers, of->face);
    if (maker->node != node)
        begin_node(maker, of);
    maker->node = node;
    bool is_corner = of->kind == LIMIT_CORNER;
    const struct vec *points = is_corner                 ? level_of(maker, n)
                               : of->kind == LIMIT_STRIP ? maker->patch[n - 1]
                                                         : maker->patch[0];
    if (bound)
        *bound = is_corner ? corner_level_bound(points, n) : bound_of_grid(points, 4, false, true);
    if (level && is_corner) {
        memset(level->texels[0], 0, sizeof level->texels[0]);
        level->texels[0][0] = texels_write_level(points, level->texels + 1);
        memcpy(level->points, points, sizeof level->points);
    } else if (level) {
        texels_write_patch(points, level->texels);
        memcpy(level->points, points, 16 * sizeof *points);
    }
    give(plan->makers, maker);
}
