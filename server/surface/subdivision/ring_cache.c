#include "server/surface/subdivision/ring_cache.h"

#include <stdlib.h>
#include <string.h>

#include "server/surface/subdivision/ring_limit.h"

void ring_cache_init(struct ring_cache *cache, size_t n_corners)
{
    *cache = (struct ring_cache){.n_corners = n_corners};
}

void ring_cache_finish(struct ring_cache *cache)
{
    for (struct cached_ring *cached = cache->newest, *older; cached; cached = older) {
        older = cached->older;
        arena_finish(&cached->memory);
        free(cached->vertex);
        free(cached);
    }
    for (int kind = 0; kind < CACHED_KINDS; kind++)
        free(cache->place[kind]);
    *cache = (struct ring_cache){0};
}

static struct cached_ring *copy(struct ring_cache *cache, const struct ring *ring)
{
    bool creased = ring->creases.edge;
    uint32_t n_edges = ring_edges(ring);
    struct cached_ring *cached = calloc(1, sizeof *cached);
    if (!cached || !arena_init(&cached->memory, ring_bytes(ring->n_faces, creased))) {
        free(cached);
        return NULL;
    }
    struct ring to = ring_take(&cached->memory, ring->n_faces, ring->closed, creased);
    memcpy(to.edge, ring->edge, n_edges * sizeof *to.edge);
    memcpy(to.face, ring->face, ring->n_faces * sizeof *to.face);
    if (creased)
        memcpy(to.creases.edge, ring->creases.edge, 2 * n_edges * sizeof *to.creases.edge);
    cached->ring = *ring;
    cached->ring.edge = to.edge;
    cached->ring.face = to.face;
    cached->ring.creases.edge = to.creases.edge;
    cached->ring.creases.far = to.creases.far;
    cached->ring.cached = cached;
    cached->owner = cache;
    cached->older = cache->newest;
    cache->newest = cached;
    return cached;
}

bool ring_cache_find(const struct ring_cache *cache, enum cached_kind kind, uint32_t corner,
                     struct ring *out)
{
    if (!cache->place[kind] || !cache->place[kind][corner].cached)
        return false;
    *out = cache->place[kind][corner].cached->ring;
    out->at = cache->place[kind][corner].at;
    return true;
}

bool ring_cache_keep(struct ring_cache *cache, enum cached_kind kind, const struct ring *ring,
                     struct cached_ring **kept)
{
    if (ring->n_faces < RING_CACHE_MIN_FACES)
        return false;
    if (!cache->place[kind])
        cache->place[kind] = calloc(cache->n_corners, sizeof *cache->place[kind]);
    *kept = cache->place[kind] ? copy(cache, ring) : NULL;
    return *kept;
}

void ring_cache_see_from(struct ring_cache *cache, enum cached_kind kind, uint32_t corner,
                         struct cached_ring *cached, uint32_t at)
{
    cache->place[kind][corner] = (struct cached_place){cached, at};
}

bool ring_cache_find_derived(const struct ring *from, uint32_t key, struct ring *out)
{
    if (!from->cached)
        return false;
    for (const struct cached_ring *derived = from->cached->derived; derived;
         derived = derived->next) {
        if (derived->key == key) {
            *out = derived->ring;
            return true;
        }
    }
    return false;
}

struct ring ring_cache_keep_derived(const struct ring *from, uint32_t key,
                                    const struct ring *derived)
{
    if (!from->cached || derived->n_faces < RING_CACHE_MIN_FACES)
        return *derived;
    struct cached_ring *cached = copy(from->cached->owner, derived);
    if (!cached)
        return *derived;
    cached->key = key;
    cached->next = from->cached->derived;
    from->cached->derived = cached;
    return cached->ring;
}

struct vertex_limit *ring_cache_vertex(const struct ring *ring)
{
    if (ring->cached && !ring->cached->vertex)
        ring->cached->vertex = calloc(1, sizeof *ring->cached->vertex);
    return ring->cached ? ring->cached->vertex : NULL;
}

struct vec ring_cache_limit(const struct ring *ring)
{
    struct vertex_limit *vertex = ring_cache_vertex(ring);
    if (!vertex)
        return ring_limit(ring);
    if (!vertex->has_limit) {
        vertex->limit = ring_limit(ring);
        vertex->has_limit = true;
    }
    return vertex->limit;
}
