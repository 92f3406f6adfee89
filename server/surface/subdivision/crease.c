#include "server/surface/subdivision/crease.h"

#include <string.h>

#include "server/cage/cage.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/topology/nonmanifold.h"

static bool is_infinite(float sharpness)
{
    return sharpness >= CAGE_SHARPNESS_INFINITE;
}

static bool is_semisharp(float sharpness)
{
    return sharpness > 0 && !is_infinite(sharpness);
}

float crease_edge(const struct ring *ring, uint32_t k)
{
    if (!ring->closed && (k == 0 || k == ring->n_faces))
        return CAGE_SHARPNESS_INFINITE;
    return ring->creases.edge ? ring->creases.edge[k] : 0;
}

float crease_child_vertex(float sharpness)
{
    return is_infinite(sharpness) ? sharpness : sharpness > 1 ? sharpness - 1 : 0;
}

void crease_add(struct crease_sum *sum, float sharpness)
{
    sum->sum += is_semisharp(sharpness) ? sharpness : 0;
    sum->n += is_semisharp(sharpness);
}

float crease_child_chaikin(float sharpness, const struct crease_sum *sum)
{
    if (is_semisharp(sharpness) && sum->n > 1) {
        float others = (sum->sum - sharpness) / (float)(sum->n - 1);
        sharpness = 0.75f * sharpness + 0.25f * others;
    }
    return crease_child_vertex(sharpness);
}

static struct crease_sum sum_of(const struct ring *ring)
{
    struct crease_sum sum = {0, 0};
    if (ring->sheets.creases)
        return ring->sheets.creases->semisharp;
    for (uint32_t k = 0; ring->creases.chaikin && k < ring_edges(ring); k++)
        crease_add(&sum, crease_edge(ring, k));
    return sum;
}

static float child_of(const struct ring *ring, uint32_t k, const struct crease_sum *sum)
{
    float sharpness = crease_edge(ring, k);
    return ring->creases.chaikin ? crease_child_chaikin(sharpness, sum)
                                 : crease_child_vertex(sharpness);
}

float crease_child(const struct ring *ring, uint32_t k)
{
    const struct crease_sum sum = sum_of(ring);
    return child_of(ring, k, &sum);
}

double crease_weight(float sharpness, float child, float far)
{
    if (sharpness <= 0)
        return 0;
    return is_infinite(sharpness) || (child > 0 && far > 0) ? 1 : sharpness;
}

double crease_edge_weight(const struct ring *in, uint32_t k)
{
    float sharpness = crease_edge(in, k);
    if (!is_semisharp(sharpness))
        return crease_weight(sharpness, sharpness, sharpness);
    return crease_weight(sharpness, crease_child(in, k), in->creases.far[k]);
}

/* At the new vertex on an edge only its two halves are sharp: what half `own` becomes there. */
static float child_at_edge_point(float own, float other, bool chaikin)
{
    if (chaikin && is_semisharp(own) && is_semisharp(other))
        own = 0.75f * own + 0.25f * other;
    return crease_child_vertex(own);
}

void crease_refine(const struct ring *in, struct ring *out)
{
    out->sharpness = crease_child_vertex(in->sharpness);
    out->creases.chaikin = in->creases.chaikin;
    out->sheets = in->sheets;
    if (in->sheets.creases && in->sheets.creases->semisharp.n)
        out->sheets.creases++;
    if (!in->creases.edge)
        return;
    const struct crease_sum sum = sum_of(in);
    for (uint32_t k = 0; k < ring_edges(in); k++) {
        out->creases.edge[k] = child_of(in, k, &sum);
        out->creases.far[k] =
            child_at_edge_point(out->creases.edge[k], in->creases.far[k], in->creases.chaikin);
    }
}

bool crease_is_semisharp(const struct ring *ring)
{
    if (is_semisharp(ring->sharpness))
        return true;
    if (ring->sheets.creases && ring->sheets.creases->semisharp.n && !is_infinite(ring->sharpness))
        return true;
    for (uint32_t k = 0; ring->creases.edge && k < ring_edges(ring); k++)
        if (is_semisharp(crease_edge(ring, k)))
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

/* Edges [first, first + n_faces] of a ring as an open ring of their own. */
static struct ring cut_sector(const struct ring *ring, uint32_t first, uint32_t n_faces, bool sharp,
                              struct arena *arena)
{
    struct ring out = ring_take(arena, n_faces, false, false);
    uint32_t n = ring_edges(ring);
    out.centre = ring->centre;
    out.cut_extraordinary = ring->cut_extraordinary || ring->n_faces != (ring->closed ? 4 : 2);
    out.sharpness = sharp ? CAGE_SHARPNESS_INFINITE : 0;
    out.sheets = ring->sheets;
    for (uint32_t k = 0; k <= n_faces; k++)
        out.edge[k] = ring->edge[(first + k) % n];
    for (uint32_t k = 0; k < n_faces; k++)
        out.face[k] = ring->face[(first + k) % n];
    return out;
}

/* Without other sheets, which matter no more but where they hold the crease. */
static struct ring alone(const struct ring *ring)
{
    struct ring out = *ring;
    const struct vertex_creases *sheets = ring->sheets.creases;
    if (!sheets)
        return out;
    if (sheets->n_sharp > 2)
        out.sharpness = CAGE_SHARPNESS_INFINITE;
    if (out.sharpness > 0 || !ring->sheets.ends_outside)
        out.sheets = (struct ring_sheets){0};
    return out;
}

struct ring crease_settle(const struct ring *ring, struct arena *arena)
{
    if (crease_is_semisharp(ring))
        return *ring;
    struct ring out = alone(ring);
    if (!ring->creases.edge)
        return out;
    uint32_t end[2], n = ring_edges(ring), n_sharp = 0;
    for (uint32_t k = 0; k < n; k++)
        n_sharp += crease_edge(ring, k) > 0;
    if (n_sharp < 2) {
        if (n_sharp == 0)
            out.creases.edge = out.creases.far = NULL;
        return out;
    }
    enum crease_rule rule = crease_vertex_rule(&out, end);
    uint32_t first = ring->at, last = (ring->at + 1) % n;
    while (crease_edge(ring, first) <= 0)
        first = (first + n - 1) % n;
    while (crease_edge(ring, last) <= 0)
        last = (last + 1) % n;
    if (!ring_cache_find_derived(ring, first, &out)) {
        uint32_t n_faces = (last + n - first) % n;
        const struct ring whole = out;
        out = cut_sector(&whole, first, n_faces ? n_faces : n, rule == RULE_CORNER, arena);
        out = ring_cache_keep_derived(ring, first, &out);
    }
    out.at = (ring->at + n - first) % n;
    return out;
}

bool crease_is_regular(const struct ring *settled)
{
    if (settled->creases.edge || settled->cut_extraordinary || ring_has_foreign_crease(settled))
        return false;
    bool sharp = settled->sharpness > 0;
    if (settled->closed)
        return settled->n_faces == 4 && !sharp;
    return settled->n_faces == (sharp ? 1 : 2);
}

bool crease_ends_at(const struct ring *settled, int edge)
{
    return !ring_has_face(settled, edge ? 1 : -1) ||
           crease_edge(settled, ring_edge_index(settled, edge)) > 0;
}
