/* What limit_plan_create() finds out about a cage before any table is filled. Private to
 * server/surface. */
#ifndef SHEEN_SURFACE_SUBDIVISION_PLAN_H
#define SHEEN_SURFACE_SUBDIVISION_PLAN_H

#include "server/surface/subdivision/extract.h"
#include "server/surface/tables.h"

/* Where one Ptex face's share of the tables begins, apart from its root node. */
struct plan_offsets {
    uint32_t node, texel, bound;
};

struct limit_plan {
    const struct cage *cage;
    struct topology topology;
    struct refined_points refined; /* empty when no face is at level 1 */
    uint32_t *first_ptex;          /* [cage faces]: its first Ptex face */
    uint32_t *corner;              /* [Ptex faces]: the cage corner at its (0,0) */
    uint8_t *hole;                 /* [cage faces]: no surface; NULL when there is none */
    struct plan_offsets *offsets;  /* [Ptex faces + 1] */
    struct dart_mask_list *modes;  /* of its darts */
    size_t n_ptex;
    size_t n_regular, n_corner, n_strip, n_split, n_hole;
    double box_min[3], box_max[3]; /* of limit positions, all over the surface */
    size_t arena_bytes;            /* what building any one face takes */
};

#endif
