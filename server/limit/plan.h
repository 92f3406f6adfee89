/* What limit_plan_create() finds out about a cage before any table is filled. Private to
 * server/limit. */
#ifndef SHEEN_LIMIT_PLAN_H
#define SHEEN_LIMIT_PLAN_H

#include "server/limit/extract.h"
#include "server/limit/tables.h"

/* Where one Ptex face's share of the tables begins, apart from its root node. */
struct plan_offsets {
    uint32_t node, point, bound;
};

struct limit_plan {
    const struct cage *cage;
    struct topology topology;
    struct refined_points refined; /* empty when the cage has quads only */
    uint32_t *first_ptex;          /* [cage faces]: its first Ptex face */
    uint32_t *corner;              /* [Ptex faces]: the cage corner at its (0,0) */
    struct plan_offsets *offsets;  /* [Ptex faces + 1] */
    size_t n_ptex;
    size_t arena_points; /* what building any one face takes */
};

/* What a Ptex face becomes. */
struct plan_shape {
    enum limit_kind root;   /* REGULAR, CORNER, SPLIT or HOLE */
    unsigned extraordinary; /* bit i: Ptex corner i */
    bool refined;           /* its quads come from level 1 of the cage */
};
struct plan_shape plan_shape_of(const struct limit_plan *plan, uint32_t ptex);

#endif
