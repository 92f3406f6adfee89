/* What is found out about a cage before any of its tables is filled: connectivity, the numbers of
 * its faces, the points of its first refinement, and where each face's share of the tables lies. */
#ifndef SHEEN_SURFACE_SUBDIVISION_PLAN_H
#define SHEEN_SURFACE_SUBDIVISION_PLAN_H

#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/extract.h"
#include "server/surface/source.h"
#include "server/surface/tables.h"

/* The most faces around a vertex, or corners of a face: dozens of such rings are held at once. */
#define LIMIT_MAX_VALENCE 4096

/* Where one Ptex face's share of the tables begins, apart from its root node. */
struct plan_offsets {
    uint32_t node, texel, bound;
};

struct limit_plan {
    struct limit_source source; /* first; maker.h */
    struct maker_pool *makers;
    unsigned n_users; /* the caller, and tables that make points from it */
    struct cage copy; /* of the cage: what the topology reads */
    const struct cage *cage;
    struct topology topology;
    struct refined_points refined; /* empty where the cage has quads alone */
    uint32_t *first_ptex;          /* [cage faces]: its first Ptex face */
    uint32_t *corner;              /* [n_ptex]: the cage corner at its (0,0) */
    uint8_t *hole;                 /* [cage faces]: no surface; NULL when there is none */
    struct plan_offsets *offsets;  /* [n_ptex + 1]; build.c fills them in */
    struct dart_mask_list *darts;  /* masks of its darts; build.c fills them in */
    size_t n_ptex;
    struct limit_size size; /* of the tables; build.c fills it in */
    size_t arena_bytes;     /* what building any one face takes at most */
};

/* All but what build.c fills in. False: ERROR_MODEL for what is not
 * evaluated, ERROR_SERVER when memory is short, or the watch's error; plan_finish() is called by
 * the caller in both cases. One thread. */
bool plan_init(struct limit_plan *plan, const struct cage *cage, const struct limit_watch *watch,
               struct error *error);
void plan_finish(struct limit_plan *plan);
/* What it takes in main memory, with the arena of one thread. */
size_t plan_bytes(const struct limit_plan *plan);

#endif
