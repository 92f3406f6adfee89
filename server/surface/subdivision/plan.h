/* The plan: what is computed about a cage before its tables are filled. It has the connectivity,
 * the numbers of its faces, the points of its first refinement, and the place of each face's share
 * of the tables. */
#ifndef SHEEN_SURFACE_SUBDIVISION_PLAN_H
#define SHEEN_SURFACE_SUBDIVISION_PLAN_H

#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/extract.h"
#include "server/surface/source.h"
#include "server/surface/tables.h"

/* The largest number of faces around a vertex, or corners of a face: dozens of such rings are kept
 * at the same time. */
#define LIMIT_MAX_VALENCE 4096

/* Where a Ptex face's share of the tables begins, apart from its root node. */
struct plan_offsets {
    uint32_t node, texel, bound;
};

struct limit_plan {
    struct limit_source source; /* must be the first member; maker.h */
    struct maker_pool *makers;
    unsigned n_users; /* the caller, and tables on demand that use it */
    struct cage copy; /* copy of the parts of the cage that the topology reads */
    const struct cage *cage;
    struct topology topology;
    struct refined_points refined; /* empty if all faces are quads */
    uint32_t *first_ptex;          /* [cage faces]: its first Ptex face */
    uint32_t *corner;              /* [n_ptex]: the cage corner at its (0,0) */
    uint8_t *hole;                 /* [cage faces]: not 0: no surface; NULL: no holes */
    struct plan_offsets *offsets;  /* [n_ptex + 1]; filled in by build.c */
    struct dart_mask_list *darts;  /* masks of its darts; filled in by build.c */
    size_t n_ptex;
    struct limit_size size; /* size of the tables; filled in by build.c */
    size_t arena_bytes;     /* the arena that building any one face needs */
};

/* Fills in the plan, except what build.c fills in. False with ERROR_MODEL for what is not
 * supported, with ERROR_SERVER when memory is short, or with the watch's error; the caller calls
 * plan_finish() in both cases. One thread. */
bool plan_init(struct limit_plan *plan, const struct cage *cage, const struct limit_watch *watch,
               struct error *error);
void plan_finish(struct limit_plan *plan);
/* Main memory of the plan and of the arena of one thread, in bytes. */
size_t plan_bytes(const struct limit_plan *plan);

#endif
