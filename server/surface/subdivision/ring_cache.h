/* Rings of large vertices, kept for all the quads around them, with what follows from them: refined
 * rings, sectors, and what a table takes from the vertex. Without that the n quads around a vertex would
 * cost n^2 steps.
 *
 * A kept ring is read only, and has ring->cached set; `at` is each user's own. Memory is about 3 % of
 * what the tables of such vertices take (12,000 bytes a corner and more). Where memory is short nothing is
 * kept: results are the same, only later. One thread. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_CACHE_H
#define SHEEN_SURFACE_SUBDIVISION_RING_CACHE_H

#include "server/surface/subdivision/dart_masks.h"

/* Making a smaller ring again takes less time than finding it. */
enum { RING_CACHE_MIN_FACES = 9 };

/* What the tables of all quads around a vertex have in common (corner.h). */
struct vertex_limit {
    bool has_limit; /* `limit` is set */
    struct vec limit;
    bool is_known;           /* the fields below are set, too */
    bool has_normal;         /* the limit surface has one there */
    struct vec axis[3];      /* of the vertex's frame */
    struct vec edges, faces; /* sums over the ring in that frame */
    struct dart_masks masks; /* of a dart */
};

struct cached_ring {
    struct ring ring;
    struct vertex_limit *vertex; /* NULL until asked for */
    /* Of a ring that follows from another: which one it is (see ring_cache_find_derived()). */
    uint32_t key;
    struct cached_ring *derived,
        *next;                 /* the first that follows from this one; the next of those */
    struct cached_ring *older; /* the one kept before */
    struct ring_cache *owner;
    struct arena memory; /* of its points */
};

/* Which ring of a cage's corner is meant: of its vertex in the cage, of its vertex in the refined cage,
 * or of its face's point there. */
enum cached_kind { CACHED_CAGE, CACHED_REFINED_CAGE, CACHED_FACE, CACHED_KINDS };

struct cached_place {
    struct cached_ring *cached;
    uint32_t at; /* which quad of the ring the corner is in */
};

struct ring_cache {
    struct cached_ring *newest;
    struct cached_place *place[CACHED_KINDS]; /* [corners], NULL until one is kept */
    size_t n_corners;
};

/* n_corners are the cage's. */
void ring_cache_init(struct ring_cache *cache, size_t n_corners);
void ring_cache_finish(struct ring_cache *cache);

/* The whole ring that a corner is in, with `at` for that corner. False where it is not kept. */
bool ring_cache_find(const struct ring_cache *cache, enum cached_kind kind, uint32_t corner,
                     struct ring *out);
/* Keeps a copy of a large ring in *kept. ring_cache_see_from() is to be called for each corner that it
 * shall be found by. False where it is not kept: the ring is small, or memory is short. */
bool ring_cache_keep(struct ring_cache *cache, enum cached_kind kind, const struct ring *ring,
                     struct cached_ring **kept);
void ring_cache_see_from(struct ring_cache *cache, enum cached_kind kind, uint32_t corner,
                         struct cached_ring *cached, uint32_t at);

/* The ring that follows from a kept one: by key RING_REFINED the refined ring, by any other key the
 * sector that begins at that edge. The caller sets its `at`. False where it is not kept. */
#define RING_REFINED UINT32_MAX
bool ring_cache_find_derived(const struct ring *from, uint32_t key, struct ring *out);
/* Keeps `derived` beside `from`, if that is kept and `derived` is large, and returns the kept ring; else
 * returns `derived`. */
struct ring ring_cache_keep_derived(const struct ring *from, uint32_t key,
                                    const struct ring *derived);

/* The record of a kept ring's vertex, for the caller to fill in. NULL: the ring is not kept, or memory
 * is short. */
struct vertex_limit *ring_cache_vertex(const struct ring *ring);

/* ring_limit(), computed once for a kept ring. */
struct vec ring_cache_limit(const struct ring *ring);

#endif
