/* One Ptex face: its tree of nodes and their tables, filled in or only measured. */
#ifndef SHEEN_SURFACE_SUBDIVISION_FACE_H
#define SHEEN_SURFACE_SUBDIVISION_FACE_H

#include "server/surface/subdivision/plan.h"

/* Where the next node, texel and bound go, and what has been made of each kind. */
struct face_builder {
    struct limit_tables *tables; /* NULL: measure only */
    const struct limit_plan *plan;
    struct arena arena;
    struct ring_cache rings;
    struct dart_mask_list **darts; /* while measuring: the plan's */
    struct plan_offsets next;
    size_t count[LIMIT_KINDS];     /* of nodes */
    double box_min[3], box_max[3]; /* of the limit positions met while measuring */
    uint32_t dart_valence;         /* of a dart that is too large to build, else 0 */
};

/* Adds a Ptex face's share from next on. Measuring and filling go the same way. */
void face_build(struct face_builder *builder, uint32_t ptex);

#endif
