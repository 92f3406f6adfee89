#include "server/surface/subdivision/shared.h"

#include <stdlib.h>
#include <string.h>

void shared_rings_init(struct shared_rings *rings, size_t n_corners)
{
    *rings = (struct shared_rings){.n_corners = n_corners};
}

void shared_rings_finish(struct shared_rings *rings)
{
    for (struct shared_ring *shared = rings->newest, *older; shared; shared = older) {
        older = shared->older;
        arena_finish(&shared->memory);
        free(shared->facts);
        free(shared);
    }
    for (int kind = 0; kind < SHARED_KINDS; kind++)
        free(rings->place[kind]);
    *rings = (struct shared_rings){0};
}

static struct shared_ring *copy(struct shared_rings *rings, const struct ring *ring)
{
    bool creased = ring->creases.edge;
    uint32_t n_edges = ring_edges(ring);
    struct shared_ring *shared = calloc(1, sizeof *shared);
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
    shared->ring.shared = shared;
    shared->owner = rings;
    shared->older = rings->newest;
    rings->newest = shared;
    return shared;
}

bool shared_find(const struct shared_rings *rings, enum shared_kind kind, uint32_t corner,
                 struct ring *out)
{
    if (!rings->place[kind] || !rings->place[kind][corner].shared)
        return false;
    *out = rings->place[kind][corner].shared->ring;
    out->at = rings->place[kind][corner].at;
    return true;
}

bool shared_keep(struct shared_rings *rings, enum shared_kind kind, const struct ring *ring,
                 struct shared_ring **kept)
{
    if (ring->n_faces < SHARED_MIN_FACES)
        return false;
    if (!rings->place[kind])
        rings->place[kind] = calloc(rings->n_corners, sizeof *rings->place[kind]);
    *kept = rings->place[kind] ? copy(rings, ring) : NULL;
    return *kept;
}

void shared_see_from(struct shared_rings *rings, enum shared_kind kind, uint32_t corner,
                     struct shared_ring *shared, uint32_t at)
{
    rings->place[kind][corner] = (struct shared_place){shared, at};
}

bool shared_find_derived(const struct ring *from, uint32_t key, struct ring *out)
{
    if (!from->shared)
        return false;
    for (const struct shared_ring *derived = from->shared->derived; derived;
         derived = derived->next) {
        if (derived->key == key) {
            *out = derived->ring;
            return true;
        }
    }
    return false;
}

struct ring shared_keep_derived(const struct ring *from, uint32_t key, const struct ring *derived)
{
    if (!from->shared || derived->n_faces < SHARED_MIN_FACES)
        return *derived;
    struct shared_ring *shared = copy(from->shared->owner, derived);
    if (!shared)
        return *derived;
    shared->key = key;
    shared->next = from->shared->derived;
    from->shared->derived = shared;
    return shared->ring;
}

struct vertex_facts *shared_facts(const struct ring *ring)
{
    if (ring->shared && !ring->shared->facts)
        ring->shared->facts = calloc(1, sizeof *ring->shared->facts);
    return ring->shared ? ring->shared->facts : NULL;
}

struct vec shared_limit(const struct ring *ring)
{
    struct vertex_facts *facts = shared_facts(ring);
    if (!facts)
        return ring_limit(ring);
    if (!facts->has_limit) {
        facts->limit = ring_limit(ring);
        facts->has_limit = true;
    }
    return facts->limit;
}
