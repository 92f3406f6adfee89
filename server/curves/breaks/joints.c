#include "server/curves/breaks/joints.h"

#include <math.h>
#include <stdlib.h>

/* A border with the place of its middle along one direction, by which borders are sorted. */
struct placed {
    double place;
    uint32_t index;
};

/* Components of a direction that no usual edge is perpendicular to, so that few middles share a place. */
static const struct vec DIRECTION = {0.5477, 0.6325, 0.5477};

size_t breaks_most_joints(size_t n_borders)
{
    return n_borders;
}

size_t breaks_joints_bytes(size_t n_borders)
{
    return n_borders * sizeof(struct placed);
}

static int by_place(const void *a, const void *b)
{
    const struct placed *p = a, *q = b;
    if (p->place != q->place)
        return p->place < q->place ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

static int by_faces(const void *a, const void *b)
{
    const struct surface_edge *p = a, *q = b;
    for (int i = 0; i < 2; i++) {
        if (p->face[i] != q->face[i])
            return p->face[i] < q->face[i] ? -1 : 1;
        if (p->edge[i] != q->edge[i])
            return p->edge[i] < q->edge[i] ? -1 : 1;
    }
    return 0;
}

static bool is_near(struct vec a, struct vec b, double distance)
{
    return vec_length(vec_sub(a, b)) < distance;
}

/* True if two borders lie together. Then *joint is set, with the border of the lower face first. */
static bool join(const struct break_border *a, const struct break_border *b, double distance,
                 struct surface_edge *joint)
{
    bool against = is_near(a->points[0], b->points[2], distance) &&
                   is_near(a->points[2], b->points[0], distance);
    bool along = is_near(a->points[0], b->points[0], distance) &&
                 is_near(a->points[2], b->points[2], distance);
    if ((!against && !along) || !is_near(a->points[1], b->points[1], distance))
        return false;
    bool in_order =
        a->of.face < b->of.face || (a->of.face == b->of.face && a->of.edge < b->of.edge);
    const struct surface_border *first = in_order ? &a->of : &b->of;
    const struct surface_border *second = in_order ? &b->of : &a->of;
    *joint = (struct surface_edge){.face = {first->face, second->face},
                                   .edge = {first->edge, second->edge},
                                   .levels = LIMIT_BORDER_SHARP,
                                   .is_joint = true,
                                   .is_flipped = !against,
                                   .from = against ? 1 : 0,
                                   .by = against ? -1 : 1};
    return true;
}

/* Comparisons for each border in the mean, after which the search ends: a model whose borders all have their middles
 * in one plane must not take minutes. Usual models need a few. */
enum { COMPARISONS = 256 };

bool breaks_find_joints(const struct break_border *borders, size_t n_borders, double distance,
                        struct surface_edge **joints, size_t *n_joints)
{
    struct placed *order = malloc((n_borders + 1) * sizeof *order);
    *joints = malloc((breaks_most_joints(n_borders) + 1) * sizeof **joints);
    *n_joints = 0;
    if (!order || !*joints) {
        free(order);
        free(*joints);
        *joints = NULL;
        return false;
    }
    size_t n = 0;
    for (size_t i = 0; i < n_borders; i++)
        /* Only where both ends are farther apart than the distance, or any border would lie on itself. */
        if (borders[i].length > 4 * distance && isfinite(borders[i].points[1].x))
            order[n++] = (struct placed){vec_dot(borders[i].points[1], DIRECTION), (uint32_t)i};
    qsort(order, n, sizeof *order, by_place);
    size_t left = n * COMPARISONS;
    for (size_t i = 0; i < n; i++)
        for (size_t k = i + 1; k < n && order[k].place - order[i].place < distance && left > 0 &&
                               *n_joints < breaks_most_joints(n_borders);
             k++, left--)
            *n_joints += join(&borders[order[i].index], &borders[order[k].index], distance,
                              &(*joints)[*n_joints]);
    qsort(*joints, *n_joints, sizeof **joints, by_faces);
    free(order);
    return true;
}
