/* Builds one Ptex face: its tree of nodes and their tables. The same code first measures a face
 * (the number of nodes, texels and bounds) and later fills it in. One thread. */
#ifndef SHEEN_SURFACE_SUBDIVISION_FACE_H
#define SHEEN_SURFACE_SUBDIVISION_FACE_H

#include "server/surface/subdivision/corner.h"
#include "server/surface/subdivision/plan.h"

struct face_builder {
    struct limit_tables *tables; /* NULL: only measure */
    const struct limit_plan *plan;
    struct arena arena;
    struct ring_cache rings;
    struct corner_nets nets;       /* the corner that is being built */
    struct dart_mask_list **darts; /* while measuring: the list of the plan */
    struct plan_offsets next;      /* places of the next node, texel and bound */
    size_t count[LIMIT_KINDS];     /* number of nodes of each kind */
    double box_min[3], box_max[3]; /* box of the limit positions, while measuring */
    uint32_t dart_valence;         /* valence of a dart that is too large to build; 0: none */
};

/* Builds the nodes of a Ptex face from builder->next on, and advances it. Cannot fail; a dart that
 * is too large is left out, and dart_valence is set. */
void face_build(struct face_builder *builder, uint32_t ptex);

/* Gets the quad of a face that is neither a hole nor plain (quad_is_plain()). Returns true if the
 * face is split into four quads, because it borders a face that is not a quad. */
bool face_quads(const struct limit_plan *plan, uint32_t ptex, struct ring_cache *rings,
                struct arena *arena, struct quad quad[4]);

#endif
