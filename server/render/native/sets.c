#include "server/render/native/sets.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "server/base/fault.h"

#define DECLARE(set)                                                                               \
    void native_pieces_##set(struct native_frame *, struct native_thread *, uint32_t);             \
    void native_tile_##set(struct native_frame *, struct native_thread *, uint32_t);               \
    void native_gaps_##set(struct native_frame *, struct native_thread *);                         \
    void native_place_##set(struct native_slice *, struct native_polygon_thread *, uint32_t);      \
    void native_triangles_##set(struct native_slice *, uint32_t);                                  \
    uint32_t native_groups_##set(const struct native_seen *, uint32_t, uint32_t, float *,          \
                                 uint32_t *);                                                      \
    bool native_see_rays_##set(const struct native_frame *, struct native_tile_room *,             \
                               struct native_ray_room *);                                          \
    void native_meet_rays_##set(const struct native_frame *, struct native_tile_room *,            \
                                struct native_ray_room *);                                         \
    void native_describe_rays_##set(const struct native_frame *, struct native_tile_room *,        \
                                    struct native_ray_room *, float(*)[HIT_WORDS]);                \
    native_program native_edges_find_##set, native_edges_recheck_##set, native_ends_find_##set,    \
        native_shade_##set, native_edges_shade_##set, native_high_curvature_shade_##set,           \
        native_rounded_shade_##set, native_shade_planes_##set, native_share_##set,                 \
        native_polygon_planes_##set, native_polygon_edges_##set;
#define SET(set, in_words, n_lanes)                                                                \
    {                                                                                              \
        .name = #set, .words = in_words, .lanes = n_lanes, .pieces = native_pieces_##set,          \
        .tile = native_tile_##set, .gaps = native_gaps_##set, .groups = native_groups_##set,       \
        .see_rays = native_see_rays_##set, .meet_rays = native_meet_rays_##set,                    \
        .describe_rays = native_describe_rays_##set, .place = native_place_##set,                  \
        .triangles = native_triangles_##set, .programs = {                                         \
            native_edges_find_##set,                                                               \
            native_edges_recheck_##set,                                                            \
            native_ends_find_##set,                                                                \
            native_shade_##set,                                                                    \
            native_edges_shade_##set,                                                              \
            native_high_curvature_shade_##set,                                                     \
            native_rounded_shade_##set,                                                            \
            native_shade_planes_##set,                                                             \
            native_share_##set,                                                                    \
            native_polygon_planes_##set,                                                           \
            native_polygon_edges_##set                                                             \
        }                                                                                          \
    }

#ifdef __x86_64__
DECLARE(v2)
DECLARE(v3)
DECLARE(v4)
/* Narrowest first. */
static const struct native_set sets[] = {SET(v2, "SSE4.2", 4), SET(v3, "AVX2", 8),
                                         SET(v4, "AVX-512", 16)};

/* Whether the processor has what a level of x86-64 requires. Instructions that every processor with the others has
 * are not checked. */
static bool has(size_t k)
{
    __builtin_cpu_init();
    if ((k >= 1 && fault_at("native.v3")) || (k >= 2 && fault_at("native.v4")))
        return false;
    if (k >= 1 && !(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2")))
        return false;
    if (k >= 2 && !(__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl")))
        return false;
    return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
}
#else
DECLARE(base)
static const struct native_set sets[] = {SET(base, "four lanes", 4)};

static bool has(size_t k)
{
    (void)k;
    return true;
}
#endif

const struct native_set *native_set_at(unsigned k)
{
    return k < sizeof sets / sizeof *sets && has(k) ? &sets[k] : NULL;
}

const struct native_set *native_set_find(const char *name)
{
    const struct native_set *found = NULL, *set;
    for (unsigned k = 0; (set = native_set_at(k)); k++)
        if (!name || strcmp(name, set->name) == 0)
            found = set;
    return found;
}
