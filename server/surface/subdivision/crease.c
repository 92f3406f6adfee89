#include "server/surface/subdivision/crease.h"

#include "server/cage/cage.h"
#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/sharpness.h"

float crease_edge(const struct ring *ring, uint32_t k)
{
    if (!ring->closed && (k == 0 || k == ring->n_faces))
        return CAGE_SHARPNESS_INFINITE;
    return ring->creases.edge ? ring->creases.edge[k] : 0;
}

static struct sharpness_sum sum_of(const struct ring *ring)
{
    struct sharpness_sum sum = {0, 0};
    if (ring->sheets.creases)
        return ring->sheets.creases->semisharp;
    for (uint32_t k = 0; ring->creases.chaikin && k < ring_edges(ring); k++)
        sharpness_add(&sum, crease_edge(ring, k));
    return sum;
}

static float child_of(const struct ring *ring, uint32_t k, const struct sharpness_sum *sum)
{
    float sharpness = crease_edge(ring, k);
    return ring->creases.chaikin ? sharpness_child_chaikin(sharpness, sum)
                                 : sharpness_child(sharpness);
}

float crease_child(const struct ring *ring, uint32_t k)
{
    const struct sharpness_sum sum = sum_of(ring);
    return child_of(ring, k, &sum);
}

double crease_edge_weight(const struct ring *in, uint32_t k)
{
    float sharpness = crease_edge(in, k);
    if (!sharpness_is_semisharp(sharpness))
        return sharpness_crease_weight(sharpness, sharpness, sharpness);
    return sharpness_crease_weight(sharpness, crease_child(in, k), in->creases.far[k]);
}

/* At the new vertex on an edge only the edge's two halves are sharp: the sharpness of half `own`
 * there. */
static float child_at_edge_point(float own, float other, bool chaikin)
{
    if (chaikin && sharpness_is_semisharp(own) && sharpness_is_semisharp(other))
        own = 0.75f * own + 0.25f * other;
    return sharpness_child(own);
}

void crease_refine(const struct ring *in, struct ring *out)
{
    out->sharpness = sharpness_child(in->sharpness);
    out->creases.chaikin = in->creases.chaikin;
    out->sheets = in->sheets;
    if (in->sheets.creases && in->sheets.creases->semisharp.n)
        out->sheets.creases++;
    if (!in->creases.edge)
        return;
    const struct sharpness_sum sum = sum_of(in);
    for (uint32_t k = 0; k < ring_edges(in); k++) {
        out->creases.edge[k] = child_of(in, k, &sum);
        out->creases.far[k] =
            child_at_edge_point(out->creases.edge[k], in->creases.far[k], in->creases.chaikin);
    }
}

bool crease_is_semisharp(const struct ring *ring)
{
    if (sharpness_is_semisharp(ring->sharpness))
        return true;
    if (ring->sheets.creases && ring->sheets.creases->semisharp.n &&
        !sharpness_is_infinite(ring->sharpness))
        return true;
    for (uint32_t k = 0; ring->creases.edge && k < ring_edges(ring); k++)
        if (sharpness_is_semisharp(crease_edge(ring, k)))
            return true;
    return false;
}

enum crease_rule crease_vertex_rule(const struct ring *ring, uint32_t end[2])
{
    uint32_t n = 0;
    end[0] = end[1] = 0;
    if (!ring->creases.edge) {
        end[1] = ring->n_faces;
        n = ring->closed ? 0 : 2;
    }
    for (uint32_t k = 0; ring->creases.edge && k < ring_edges(ring); k++) {
        if (crease_edge(ring, k) <= 0)
            continue;
        if (n < 2)
            end[n] = k;
        n++;
    }
    if (ring->sheets.creases)
        n = ring->sheets.creases->n_sharp;
    if (ring->sharpness > 0 || n > 2)
        return RULE_CORNER;
    return n == 2 ? RULE_CREASE : n == 1 ? RULE_DART : RULE_SMOOTH;
}
