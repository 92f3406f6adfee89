/* What the quads around a large vertex have in common: its ring, the rings that follow from it, and
 * what a table takes from those; made once for all of them, or n faces would cost n^2 steps.
 *
 * A ring that is kept here is read only, and points here (ring->cached); its `at` is each user's
 * own. Takes about 3 % of what the tables of such vertices take (12,000 bytes a corner and more).
 * Where memory is short nothing is kept and everything comes out the same, only later. One thread.
 */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_CACHE_H
#define SHEEN_SURFACE_SUBDIVISION_RING_CACHE_H

#include "server/surface/subdivision/dart_masks.h"

/* Smaller rings are made anew faster than they are found. */
enum { RING_CACHE_MIN_FACES = 9 };

/* The vertex as tables see it (corner.h). */
struct vertex_limit {
    bool has_limit; /* the limit position is known */
    struct vec limit;
    bool is_known;      /* the rest is */
    bool has_normal;    /* the limit surface has one there */
    struct vec axis[3]; /* of its frame; without a normal each face finds its own by this one */
    struct vec edges, faces; /* sums over the ring in that frame */
    struct dart_masks modes; /* of a dart */
};

struct cached_ring {
    struct ring ring;
    struct vertex_limit *facts; /* NULL until asked for */
    /* What follows from this one, by key: the refined ring, or the sector from an edge on. */
    uint32_t key;
    struct cached_ring *derived, *next;
    struct cached_ring *older; /* of all */
    struct ring_cache *owner;
    struct arena memory; /* the ring's */
};

/* Which ring a corner of the cage is in: of its vertex in the cage, of that in the refined cage, or
 * of its face's point there. */
enum cached_kind { CACHED_CAGE, CACHED_REFINED_CAGE, CACHED_FACE, CACHED_KINDS };

struct cached_place {
    struct cached_ring *shared;
    uint32_t at;
};

struct ring_cache {
    struct cached_ring *newest;
    struct cached_place *place[CACHED_KINDS]; /* [corners], NULL until one is kept */
    size_t n_corners;
};

void ring_cache_init(struct ring_cache *rings, size_t n_corners);
void ring_cache_finish(struct ring_cache *rings);

/* The whole ring that a corner is in, as seen from there. False where it is not kept. */
bool ring_cache_find(const struct ring_cache *rings, enum cached_kind kind, uint32_t corner,
                     struct ring *out);
/* Keeps a copy, if it is large. ring_cache_see_from() then tells from which corners it is seen.
 * False where it is not kept. */
bool ring_cache_keep(struct ring_cache *rings, enum cached_kind kind, const struct ring *ring,
                     struct cached_ring **kept);
void ring_cache_see_from(struct ring_cache *rings, enum cached_kind kind, uint32_t corner,
                         struct cached_ring *shared, uint32_t at);

/* The ring that follows from a kept one: RING_REFINED, or the sector that begins at edge `key`.
 * Its `at` is for the caller to set. */
#define RING_REFINED UINT32_MAX
bool ring_cache_find_derived(const struct ring *from, uint32_t key, struct ring *out);
/* `derived`, kept where `from` is. */
struct ring ring_cache_keep_derived(const struct ring *from, uint32_t key,
                                    const struct ring *derived);

/* Of a kept ring, to be filled in; NULL where there is none. */
struct vertex_limit *ring_cache_vertex(const struct ring *ring);

/* ring_limit() of a settled ring that is no dart. */
struct vec ring_cache_limit(const struct ring *ring);

#endif
