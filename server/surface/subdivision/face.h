/* One Ptex face: its tree of nodes and their tables. A face is built twice on the same way: first only
 * measured (how many nodes, texels and bounds it takes), later filled in. Thread: the builder's. */
#ifndef SHEEN_SURFACE_SUBDIVISION_FACE_H
#define SHEEN_SURFACE_SUBDIVISION_FACE_H

#include "server/surface/subdivision/corner.h"
#include "server/surface/subdivision/plan.h"

struct face_builder {
    struct limit_tables *tables; /* NULL: measure only */
    const struct limit_plan *plan;
    struct arena arena;
    struct ring_cache rings;
    struct corner_nets nets;       /* of the corner that is being built */
    struct dart_mask_list **darts; /* while measuring: the plan's */
    struct plan_offsets next;      /* where the next node, texel and bound go */
    size_t count[LIMIT_KINDS];     /* of nodes */
    double box_min[3], box_max[3]; /* of the limit positions met while measuring */
    uint32_t dart_valence;         /* of a dart that is too large to build, else 0 */
};

/* Builds a Ptex face's nodes from builder->next on, and moves that on. Never fails; a dart that is too
 * large is left out and told in dart_valence. */
void face_build(struct face_builder *builder, uint32_t ptex);

/* The quad of a face that is no hole and not plain (quad_is_plain()); or, returning true, the four that
 * it is split into, where it borders a face that is no quad. */
bool face_quads(const struct limit_plan *plan, uint32_t ptex, struct ring_cache *rings,
                struct arena *arena, struct quad quad[4]);

/* Moves the mean of a patch's points to zero, and returns it: the origin of a REGULAR node. */
struct vec regular_centre(struct vec grid[16]);

#endif
