/* Keeps the rings of large vertices for all quads around them, with what follows from them: refined
 * rings, sectors, and what a table needs of the vertex. Otherwise the n quads around a vertex would
 * take n^2 steps.
 *
 * A kept ring is read-only and has ring->cached set; each user has its own `at`. The memory is
 * about 3 % of the tables of such vertices (at least 12,000 bytes a corner). When memory is short
 * nothing is kept: results are the same, but take longer.
 * Thread: one. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_CACHE_H
#define SHEEN_SURFACE_SUBDIVISION_RING_CACHE_H

#include "server/surface/subdivision/dart_masks.h"

/* Making a smaller ring again is faster than finding it. */
enum { RING_CACHE_MIN_FACES = 9 };

/* What the tables of all quads around a vertex have in common (corner.h). */
struct vertex_limit {
    bool has_limit; /* `limit` is valid */
    struct vec limit;
    bool is_known;           /* the members below are valid, too */
    bool has_normal;         /* the limit surface has a single normal there */
    struct vec axis[3];      /* of the vertex's frame */
    struct vec edges, faces; /* sums over the ring, in that frame */
    struct dart_masks masks; /* if it is a dart */
};

struct cached_ring {
    struct ring ring;
    struct vertex_limit *vertex; /* NULL until needed */
    /* The key of a derived ring (ring_cache_find_derived()). */
    uint32_t key;
    struct cached_ring *derived,
        /* The first ring derived from this one; the next one with the same origin. */
        *next;
    struct cached_ring *older; /* the entry kept before this one */
    struct ring_cache *owner;
    struct arena memory; /* memory of its points */
};

/* The kind of ring at a corner of the cage: around its vertex in the cage, around its vertex in the
 * refined cage, or around its face's point there. */
enum cached_kind { CACHED_CAGE, CACHED_REFINED_CAGE, CACHED_FACE, CACHED_KINDS };

struct cached_place {
    struct cached_ring *cached;
    uint32_t at; /* the quad of the ring with this corner */
};

struct ring_cache {
    struct cached_ring *newest;
    struct cached_place *place[CACHED_KINDS]; /* [corners]; NULL until one is kept */
    size_t n_corners;
};

/* n_corners is the cage's number of corners. */
void ring_cache_init(struct ring_cache *cache, size_t n_corners);
void ring_cache_finish(struct ring_cache *cache);

/* Finds the whole ring of a corner, with `at` set to that corner. False if it is not kept. */
bool ring_cache_find(const struct ring_cache *cache, enum cached_kind kind, uint32_t corner,
                     struct ring *out);
/* Keeps a copy of a large ring in *kept. Call ring_cache_see_from() for each corner from which it
 * shall be found. False if it is not kept, because the ring is small or memory is short. */
bool ring_cache_keep(struct ring_cache *cache, enum cached_kind kind, const struct ring *ring,
                     struct cached_ring **kept);
void ring_cache_see_from(struct ring_cache *cache, enum cached_kind kind, uint32_t corner,
                         struct cached_ring *cached, uint32_t at);

/* Finds a ring derived from a kept one: with key RING_REFINED the refined ring, with any other key
 * the sector that begins at that edge. The caller sets its `at`. False if it is not kept. */
#define RING_REFINED UINT32_MAX
bool ring_cache_find_derived(const struct ring *from, uint32_t key, struct ring *out);
/* Keeps `derived` with `from`, if that is kept and `derived` is large, and returns the kept ring;
 * else returns `derived`. */
struct ring ring_cache_keep_derived(const struct ring *from, uint32_t key,
                                    const struct ring *derived);

/* The record of a kept ring's vertex, for the caller to fill in. NULL if the ring is not kept or
 * memory is short. */
struct vertex_limit *ring_cache_vertex(const struct ring *ring);

/* ring_limit(); for a kept ring it is computed once. */
struct vec ring_cache_limit(const struct ring *ring);

#endif
