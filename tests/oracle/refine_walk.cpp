#include "tests/oracle/refine_walk.h"

#include <cmath>
#include <memory>
#include <stdexcept>

#include "tests/oracle/osd_levels.h"

namespace
{

/* Both sides of the comparison, during their common descent. */
struct walker {
    const limit_plan *plan;
    const osd_levels *truth;
    int n_levels;
    struct arena arena;
    struct ring_cache rings;
    refine_walk found;

    /* The quad is face `face` of that level, with the same first corner. */
    void compare(const quad &quad, int level, int face)
    {
        double &distance = found.distance[(size_t)level];
        found.n_faces[(size_t)level]++;
        for (int i = 0; i < 4; i++) {
            const vec &p = quad.corner[i].centre;
            vec3 there = truth->vertex(level, face, i);
            double off = length(vec3{p.x, p.y, p.z} - there);
            distance = off <= distance ? distance : off; /* also true for NaN */
        }
        if (level == n_levels)
            return;
        size_t mark = arena.used;
        struct quad child[4];
        quad_refine(&quad, &arena, child);
        for (int i = 0; i < 4; i++)
            compare(child[i], level + 1, truth->child(level, face, i));
        arena.used = mark;
    }
};

bool touches_ngon(const topology &t, uint32_t corner)
{
    for (int i = 0; i < 4; i++, corner = corner_next(&t, corner))
        if (t.vertex_flags[corner_vertex(&t, corner)] & VERTEX_BY_NGON)
            return true;
    return false;
}

/* Begins at level 0 if all faces around are quads, else at level 1. */
void compare_face(walker *walk, uint32_t face)
{
    const topology &t = walk->plan->topology;
    uint32_t first = t.cage->face_start[face], n = face_size(&t, face);
    walk->arena.used = 0;
    if (n == 4 && !touches_ngon(t, first)) {
        quad quad = extract_quad(&t, first, &walk->rings, &walk->arena);
        walk->compare(quad, 0, (int)face);
        return;
    }
    for (uint32_t k = 0; k < n; k++) {
        walk->arena.used = 0;
        quad quad =
            extract_refined_quad(&t, &walk->plan->refined, first + k, &walk->rings, &walk->arena);
        if (n == 4)
            quad = quad_rotated(&quad, (4 - k) & 3); /* the children of a quad keep its
                                                      * orientation */
        walk->compare(quad, 1, walk->truth->child(0, (int)face, (int)k));
    }
}

} // namespace

refine_walk walk_levels(const cage &cage, int n_levels)
{
    osd_levels truth(cage, n_levels);
    error error;
    std::unique_ptr<limit_plan, void (*)(limit_plan *)> plan(limit_plan_create(&cage, NULL, &error),
                                                             limit_plan_destroy);
    if (!plan)
        throw std::runtime_error(error.text);
    walker walk = {};
    walk.plan = plan.get();
    walk.truth = &truth;
    walk.n_levels = n_levels;
    walk.found.distance.resize((size_t)n_levels + 1);
    walk.found.n_faces.resize((size_t)n_levels + 1);
    if (!arena_init(&walk.arena, plan->arena_bytes))
        throw std::runtime_error("out of memory");
    ring_cache_init(&walk.rings, cage.face_start[cage.n_faces]);
    for (uint32_t face = 0; face < cage.n_faces; face++)
        compare_face(&walk, face);
    ring_cache_finish(&walk.rings);
    arena_finish(&walk.arena);
    return walk.found;
}

double cage_diagonal(const cage &cage)
{
    double size2 = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < cage.n_vertices; i++) {
            low = std::fmin(low, cage.position[i][k]);
            high = std::fmax(high, cage.position[i][k]);
        }
        size2 += (high - low) * (high - low);
    }
    return std::sqrt(size2);
}
