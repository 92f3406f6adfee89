#include "server/surface/subdivision/adjacency.h"

static bool is_quad(const struct topology *t, uint32_t corner)
{
    return face_size(t, t->face[corner]) == 4;
}

/* The Ptex face and edge that contain the start of half-edge c: a quad's whole edge, or edge 0 of
 * the n-gon's Ptex face at c. */
static uint32_t edge_at_start(const struct limit_plan *plan, uint32_t c)
{
    const struct topology *t = &plan->topology;
    uint32_t face = t->face[c], k = c - t->cage->face_start[face];
    return is_quad(t, c) ? plan->first_ptex[face] << 2 | k : (plan->first_ptex[face] + k) << 2;
}

/* As edge_at_start() for the end of the half-edge: edge 3 of the n-gon's Ptex face at the next
 * corner. */
static uint32_t edge_at_end(const struct limit_plan *plan, uint32_t c)
{
    const struct topology *t = &plan->topology;
    if (is_quad(t, c))
        return edge_at_start(plan, c);
    return edge_at_start(plan, corner_next(t, c)) | 3;
}

struct limit_adjacency adjacency_of(const struct limit_plan *plan, uint32_t ptex)
{
    const struct topology *t = &plan->topology;
    struct limit_adjacency out;
    uint32_t c = plan->corner[ptex];
    if (is_quad(t, c)) {
        /* The end of this face's edge is the start of its twin. */
        for (unsigned e = 0; e < 4; e++, c = corner_next(t, c))
            out.across[e] =
                t->twin[c] == CORNER_NONE ? LIMIT_NO_FACE : edge_at_start(plan, t->twin[c]);
        return out;
    }
    uint32_t before = corner_prev(t, c), first = plan->first_ptex[t->face[c]];
    uint32_t next_ptex = first + (corner_next(t, c) - t->cage->face_start[t->face[c]]);
    uint32_t prev_ptex = first + (before - t->cage->face_start[t->face[c]]);
    out.across[0] = t->twin[c] == CORNER_NONE ? LIMIT_NO_FACE : edge_at_end(plan, t->twin[c]);
    out.across[1] = next_ptex << 2 | 2;
    out.across[2] = prev_ptex << 2 | 1;
    out.across[3] =
        t->twin[before] == CORNER_NONE ? LIMIT_NO_FACE : edge_at_start(plan, t->twin[before]);
    return out;
}
