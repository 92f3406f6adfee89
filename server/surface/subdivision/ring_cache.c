#include "server/surface/subdivision/ring_cache.h"

#include <stdlib.h>
#include <string.h>

#include "server/surface/subdivision/ring_limit.h"

void ring_cache_init(struct ring_cache *rings, size_t n_corners)
{
    *rings = (struct ring_cache){.n_corners = n_corners};
}

void ring_cache_finish(struct ring_cache *rings)
{
    for (struct cached_ring *shared = rings->newest, *older; shared; shared = older) {
        older = shared->older;
        arena_finish(&shared->memory);
        free(shared->facts);
        free(shared);
    }
    for (int kind = 0; kind < CACHED_KINDS; kind++)
        free(rings->place[kind]);
    *rings = (struct ring_cache){0};
}

static struct cached_ring *copy(struct ring_cache *rings, const struct ring *ring)
{
    bool creased = ring->creases.edge;
    uint32_t n_edges = ring_edges(ring);
    struct cached_ring *shared = calloc(1, sizeof *shared);
    if (!shared || !arena_init(&shared->memory, ring_bytes(ring->n_faces, creased))) {
        free(shared);
        return NULL;
    }
    struct ring to = ring_take(&shared->memory, ring->n_faces, ring->closed, creased);
    memcpy(to.edge, ring->edge, n_edges * sizeof *to.edge);
    memcpy(to.face, ring->face, ring->n_faces * sizeof *to.face);
    if (creased)
        memcpy(to.creases.edge, ring->creases.edge, 2 * n_edges * sizeof *to.creases.edge);
    shared->ring = *ring;
    shared->ring.edge = to.edge;
    shared->ring.face = to.face;
    shared->ring.creases.edge = to.creases.edge;
    shared->ring.creases.far = to.creases.far;
    shared->ring.cached = shared;
    shared->owner = rings;
    shared->older = rings->newest;
    rings->newest = shared;
    return shared;
}

bool ring_cache_find(const struct ring_cache *rings, enum cached_kind kind, uint32_t corner,
                     struct ring *out)
{
    if (!rings->place[kind] || !rings->place[kind][corner].shared)
        return false;
    *out = rings->place[kind][corner].shared->ring;
    out->at = rings->place[kind][corner].at;
    return true;
}

bool ring_cache_keep(struct ring_cache *rings, enum cached_kind kind, const struct ring *ring,
                     struct cached_ring **kept)
{
    if (ring->n_faces < RING_CACHE_MIN_FACES)
        return false;
    if (!rings->place[kind])
        rings->place[kind] = calloc(rings->n_corners, sizeof *rings->place[kind]);
    *kept = rings->place[kind] ? copy(rings, ring) : NULL;
    return *kept;
}

void ring_cache_see_from(struct ring_cache *rings, enum cached_kind kind, uint32_t corner,
                         struct cached_ring *shared, uint32_t at)
{
    rings->place[kind][corner] = (struct cached_place){shared, at};
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
    struct cached_ring *shared = copy(from->cached->owner, derived);
    if (!shared)
        return *derived;
    shared->key = key;
    shared->next = from->cached->derived;
    from->cached->derived = shared;
    return shared->ring;
}

struct vertex_limit *ring_cache_vertex(const struct ring *ring)
{
    if (ring->cached && !ring->cached->facts)
        ring->cached->facts = calloc(1, sizeof *ring->cached->facts);
    return ring->cached ? ring->cached->facts : NULL;
}

struct vec ring_cache_limit(const struct ring *ring)
{
    struct vertex_limit *facts = ring_cache_vertex(ring);
    if (!facts)
        return ring_limit(ring);
    if (!facts->has_limit) {
        facts->limit = ring_limit(ring);
        facts->has_limit = true;
    }
    return facts->limit;
}
