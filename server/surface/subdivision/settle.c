#include "server/surface/subdivision/settle.h"

#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/sharpness.h"

/* Cuts out edges first to first + n_faces of a ring as an open ring. */
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

/* The ring without other sheets, unless these have a crease that does not end this one. A vertex
 * that is sharp because of the edges of all sheets becomes sharp by itself. */
static struct ring alone(const struct ring *ring)
{
    struct ring out = *ring;
    const struct vertex_creases *sheets = ring->sheets.creases;
    if (!sheets)
        return out;
    if (sheets->n_sharp > 2)
        out.sharpness = CAGE_SHARPNESS_INFINITE;
    if (out.sharpness > 0 || !ring->sheets.crease_is_outside)
        out.sheets = (struct ring_sheets){0};
    return out;
}

struct ring ring_settle(const struct ring *ring, struct arena *arena)
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

bool ring_is_regular(const struct ring *settled)
{
    if (settled->creases.edge || settled->cut_extraordinary || ring_has_outside_crease(settled))
        return false;
    bool sharp = settled->sharpness > 0;
    if (settled->closed)
        return settled->n_faces == 4 && !sharp;
    return settled->n_faces == (sharp ? 1 : 2);
}

bool ring_ends_at(const struct ring *settled, int edge)
{
    return !ring_has_face(settled, edge ? 1 : -1) ||
           crease_edge(settled, ring_edge_index(settled, edge)) > 0;
}
