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

struct joint_distances breaks_joint_distances(double gap_limit, double diagonal)
{
    return (struct joint_distances){.same_side = fmax(10 * gap_limit, 1e-4 * diagonal),
                                    .continued = fmax(10 * gap_limit, 1e-3 * diagonal)};
}

/* How near another border must be to lie on this one. */
static double reach_of(const struct break_border *border, double distance)
{
    return fmin(distance, 0.25 * fmin(border->length, vec_length(border->across)));
}

/* True if the angle between the directions into both faces is below 60 degrees. */
static bool is_same_side(const struct break_border *a, const struct break_border *b)
{
    return vec_dot(a->across, b->across) > 0.5 * vec_length(a->across) * vec_length(b->across);
}

/* True if two borders lie together. Then *joint is set, with the border of the lower face first. */
static bool join(const struct break_border *a, const struct break_border *b,
                 struct joint_distances distances, struct surface_edge *joint)
{
    double wanted = is_same_side(a, b) ? distances.same_side : distances.continued;
    double distance = fmin(reach_of(a, wanted), reach_of(b, wanted));
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

bool breaks_find_joints(const struct break_border *borders, size_t n_borders,
                        struct joint_distances distances, struct surface_edge **joints,
                        size_t *n_joints)
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
        if (borders[i].length > 0 && isfinite(borders[i].points[1].x))
            order[n++] = (struct placed){vec_dot(borders[i].points[1], DIRECTION), (uint32_t)i};
    qsort(order, n, sizeof *order, by_place);
    size_t left = n * COMPARISONS;
    for (size_t i = 0; i < n; i++)
        for (size_t k = i + 1; k < n && left > 0 && *n_joints < breaks_most_joints(n_borders);
             k++, left--) {
            const struct break_border *a = &borders[order[i].index];
            if (order[k].place - order[i].place >= reach_of(a, distances.continued))
                break;
            *n_joints += join(a, &borders[order[k].index], distances, &(*joints)[*n_joints]);
        }
    qsort(*joints, *n_joints, sizeof **joints, by_faces);
    free(order);
    return true;
}
