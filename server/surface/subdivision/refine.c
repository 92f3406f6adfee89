#include "server/surface/subdivision/refine.h"

#include "server/surface/subdivision/crease.h"
#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/sharpness.h"

static void refine_faces(const struct ring *in, struct ring *out)
{
    uint32_t n = ring_edges(in);
    for (uint32_t k = 0; k < in->n_faces; k++) {
        struct vec next = in->edge[k + 1 == n ? 0 : k + 1];
        struct vec sum = vec_add(vec_add(in->centre, in->face[k]), vec_add(in->edge[k], next));
        out->face[k] = vec_scale(sum, 0.25);
    }
}

static void refine_edges(const struct ring *in, struct ring *out)
{
    for (uint32_t k = 0; k < ring_edges(in); k++) {
        struct vec ends = vec_add(in->centre, in->edge[k]);
        double crease = crease_edge_weight(in, k);
        if (crease == 1) {
            out->edge[k] = vec_scale(ends, 0.5);
            continue;
        }
        struct vec sides = vec_add(out->face[k ? k - 1 : in->n_faces - 1], out->face[k]);
        struct vec smooth = vec_scale(vec_add(ends, sides), 0.25);
        out->edge[k] = vec_mad(vec_scale(smooth, 1 - crease), 0.5 * crease, ends);
    }
}

/* The new vertex by one rule. `out` has the new face points. */
static struct vec centre_by_rule(const struct ring *in, const struct ring *out,
                                 enum crease_rule rule, const uint32_t end[2])
{
    if (rule == RULE_CORNER)
        return in->centre;
    if (rule == RULE_CREASE) {
        const struct vec *outside = in->sheets.creases ? in->sheets.end : NULL;
        struct vec ends =
            outside ? vec_add(outside[0], outside[1]) : vec_add(in->edge[end[0]], in->edge[end[1]]);
        return vec_mad(vec_scale(in->centre, 0.75), 0.125, ends);
    }
    double n = in->n_faces;
    struct vec sum = {0, 0, 0};
    for (uint32_t k = 0; k < in->n_faces; k++)
        sum = vec_add(sum, vec_add(in->edge[k], out->face[k]));
    return vec_mad(vec_scale(in->centre, (n - 2) / n), 1 / (n * n), sum);
}

/* The weight of the old rule if the rule changes in this step: the mean of the sharpness that runs
 * out in the step, at most 1, in single precision like all sharpness (server/surface/README.md
 * 5). */
static double rule_weight(const struct ring *in, const struct ring *out)
{
    const struct vertex_creases *sheets = in->sheets.creases;
    struct sharpness_sum ending = {0, 0};
    if (out->sharpness <= 0)
        sharpness_add(&ending, in->sharpness);
    for (uint32_t k = 0; !sheets && in->creases.edge && k < ring_edges(in); k++)
        if (crease_edge(out, k) <= 0)
            sharpness_add(&ending, crease_edge(in, k));
    /* Edges of other sheets count, too. The rule changes only in the step in which all have run
     * out, so every entry of the list runs out now. */
    if (sheets) {
        ending.sum += sheets->semisharp.sum;
        ending.n += sheets->semisharp.n;
    }
    return ending.n ? fmin((double)(ending.sum / (float)ending.n), 1) : 0;
}

static struct vec refine_centre(const struct ring *in, const struct ring *out)
{
    uint32_t end[2], child_end[2];
    enum crease_rule rule = crease_vertex_rule(in, end);
    struct vec centre = centre_by_rule(in, out, rule, end);
    if (rule == RULE_SMOOTH || rule == RULE_DART)
        return centre;
    enum crease_rule child = crease_vertex_rule(out, child_end);
    if (child == rule)
        return centre;
    double weight = rule_weight(in, out);
    struct vec other = centre_by_rule(in, out, child, child_end);
    return vec_mad(vec_scale(centre, weight), 1 - weight, other);
}

void ring_refine_around(const struct ring *in, struct ring *out)
{
    out->at = in->at;
    out->cut_extraordinary = in->cut_extraordinary;
    crease_refine(in, out);
    refine_edges(in, out);
    for (int k = 0; k < 2; k++)
        out->sheets.end[k] = vec_scale(vec_add(in->centre, in->sheets.end[k]), 0.5);
    out->centre = refine_centre(in, out);
}

void ring_refine(const struct ring *in, struct ring *out)
{
    refine_faces(in, out);
    ring_refine_around(in, out);
}
