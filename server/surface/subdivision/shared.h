/* What the quads around a large vertex have in common: its ring, the rings that follow from it, and
 * what a table takes from those; made once for all of them, or n faces would cost n^2 steps.
 *
 * A ring that is kept here is read only, and points here (ring->shared); its `at` is each user's
 * own. Takes about 3 % of what the tables of such vertices take (12,000 bytes a corner and more).
 * Where memory is short nothing is kept and everything comes out the same, only later. One thread.
 */
#ifndef SHEEN_SURFACE_SUBDIVISION_SHARED_H
#define SHEEN_SURFACE_SUBDIVISION_SHARED_H

#include "server/surface/subdivision/modes.h"

/* Smaller rings are made anew faster than they are found. */
enum { SHARED_MIN_FACES = 9 };

/* The vertex as tables see it (corner.h). */
struct vertex_facts {
    bool has_limit; /* the limit position is known */
    struct vec limit;
    bool is_known;      /* the rest is */
    bool has_normal;    /* the limit surface has one there */
    struct vec axis[3]; /* of its frame; without a normal each face finds its own by this one */
    struct vec edges, faces; /* sums over the ring in that frame */
    struct ring_modes modes; /* of a dart */
};

struct shared_ring {
    struct ring ring;
    struct vertex_facts *facts; /* NULL until asked for */
    /* What follows from this one, by key: the refined ring, or the sector from an edge on. */
    uint32_t key;
    struct shared_ring *derived, *next;
    struct shared_ring *older; /* of all */
    struct shared_rings *owner;
    struct arena memory; /* the ring's */
};

/* Which ring a corner of the cage is in: of its vertex in the cage, of that in the refined cage, or
 * of its face's point there. */
enum shared_kind { SHARED_CAGE, SHARED_REFINED_CAGE, SHARED_FACE, SHARED_KINDS };

struct shared_place {
    struct shared_ring *shared;
    uint32_t at;
};

struct shared_rings {
    struct shared_ring *newest;
    struct shared_place *place[SHARED_KINDS]; /* [corners], NULL until one is kept */
    size_t n_corners;
};

void shared_rings_init(struct shared_rings *rings, size_t n_corners);
void shared_rings_finish(struct shared_rings *rings);

/* The whole ring that a corner is in, as seen from there. False where it is not kept. */
bool shared_find(const struct shared_rings *rings, enum shared_kind kind, uint32_t corner,
                 struct ring *out);
/* Keeps a copy, if it is large. shared_see_from() then tells from which corners it is seen. False
 * where it is not kept. */
bool shared_keep(struct shared_rings *rings, enum shared_kind kind, const struct ring *ring,
                 struct shared_ring **kept);
void shared_see_from(struct shared_rings *rings, enum shared_kind kind, uint32_t corner,
                     struct shared_ring *shared, uint32_t at);

/* The ring that follows from a kept one: SHARED_REFINED, or the sector that begins at edge `key`.
 * Its `at` is for the caller to set. */
#define SHARED_REFINED UINT32_MAX
bool shared_find_derived(const struct ring *from, uint32_t key, struct ring *out);
/* `derived`, kept where `from` is. */
struct ring shared_keep_derived(const struct ring *from, uint32_t key, const struct ring *derived);

/* Of a kept ring, to be filled in; NULL where there is none. */
struct vertex_facts *shared_facts(const struct ring *ring);

/* ring_limit() of a settled ring that is no dart. */
struct vec shared_limit(const struct ring *ring);

#endif
