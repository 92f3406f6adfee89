#include "server/cage/joints.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_COMPARISONS = 256, /* for each edge in the mean */
    MOST_MATES = 8          /* that an edge looks for among those after it */
};

/* A direction along which the middles of edges are sorted; few models have many edges across it. */
static const double DIRECTION[3] = {0.5773, 0.6137, 0.5386};

struct edge {
    double key; /* the middle's place along DIRECTION */
    double point[4][3];
    uint32_t name; /* patch << 2 | edge */
};

struct found {
    const struct edge *mate;
    uint32_t n;    /* edges that lie together with it, as far as they are counted */
    bool is_along; /* the mate runs the same way */
};

void cage_patch_edge(double bezier[16][3], unsigned e, double out[4][3])
{
    static const int first[4] = {0, 3, 15, 12}, step[4] = {1, 4, -1, -4};
    for (int k = 0; k < 4; k++)
        memcpy(out[k], bezier[first[e] + k * step[e]], sizeof out[k]);
}

static bool is_near(const double a[3], const double b[3], double distance)
{
    for (int k = 0; k < 3; k++)
        if (!(fabs(a[k] - b[k]) <= distance))
            return false;
    return true;
}

static bool is_collapsed(const struct edge *edge, double distance)
{
    for (int k = 1; k < 4; k++)
        if (!is_near(edge->point[k], edge->point[0], distance))
            return false;
    return true;
}

/* True if the edges lie together, in one direction or the other. */
static bool lie_together(const struct edge *a, const struct edge *b, bool along, double distance)
{
    for (int k = 0; k < 4; k++)
        if (!is_near(a->point[k], b->point[along ? k : 3 - k], distance))
            return false;
    return true;
}

static int by_key(const void *a, const void *b)
{
    const struct edge *p = a, *q = b;
    if (p->key != q->key)
        return p->key < q->key ? -1 : 1;
    return p->name < q->name ? -1 : p->name > q->name;
}

/* 1e-9 of the diagonal, and what rounding does to coordinates far from the origin. */
static double tolerance_of(const struct cage *cage)
{
    double diagonal = 0, farthest = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < cage->n_patches; i++)
            for (int p = 0; p < 16; p++) {
                low = fmin(low, cage->patch[i].point[p][k]);
                high = fmax(high, cage->patch[i].point[p][k]);
            }
        diagonal = hypot(diagonal, high - low);
        farthest = fmax(farthest, fmax(fabs(low), fabs(high)));
    }
    return 1e-9 * diagonal + 4e-15 * farthest;
}

/* Lists all edges that are not collapsed, sorted. */
static size_t list_edges(const struct cage *cage, double distance, uint8_t *collapsed,
                         struct edge *edges)
{
    size_t n = 0;
    for (uint32_t i = 0; i < cage->n_patches; i++) {
        double bezier[16][3];
        cage_patch_bezier(&cage->patch[i], bezier);
        for (unsigned e = 0; e < 4; e++) {
            struct edge *edge = &edges[n];
            *edge = (struct edge){.name = i << 2 | e};
            cage_patch_edge(bezier, e, edge->point);
            for (int k = 0; k < 3; k++)
                edge->key += DIRECTION[k] / 8 *
                             (edge->point[0][k] + 3 * (edge->point[1][k] + edge->point[2][k]) +
                              edge->point[3][k]);
            bool is_point = is_collapsed(edge, distance);
            collapsed[i] |= (uint8_t)(is_point << e);
            n += !is_point;
        }
    }
    qsort(edges, n, sizeof *edges, by_key);
    return n;
}

static void meet(struct found *found, const struct edge *mate, bool along)
{
    found->n++;
    found->mate = mate;
    found->is_along = along;
}

/* Counts the edges that lie together with each edge. An edge stops after MOST_MATES: its place is tangled then, and
 * those that it leaves out meet its mates, so that a place with very many edges takes a time that is linear in them. */
static void match(const struct edge *edges, struct found *found, size_t n, double distance)
{
    size_t left = n * MOST_COMPARISONS;
    for (size_t a = 0; a < n; a++) {
        unsigned n_mates = 0;
        for (size_t b = a + 1; b < n && n_mates < MOST_MATES && left > 0; b++, left--) {
            if (edges[b].key - edges[a].key > 2 * distance)
                break;
            bool along = lie_together(&edges[a], &edges[b], true, distance);
            if (!along && !lie_together(&edges[a], &edges[b], false, distance))
                continue;
            meet(&found[a], &edges[b], along);
            meet(&found[b], &edges[a], along);
            n_mates++;
        }
    }
}

/* Joins an edge with its only mate, or counts why there is none. */
static void settle(struct cage_joints *joints, const struct edge *edges, const struct found *found,
                   size_t i)
{
    uint32_t patch = edges[i].name >> 2;
    bool is_pair = found[i].n == 1 && found[found[i].mate - edges].n == 1;
    if (found[i].n == 0) {
        joints->n_boundary++;
    } else if (!is_pair) {
        joints->n_tangled++;
    } else if (!found[i].is_along) {
        joints->across[patch][edges[i].name & 3] = found[i].mate->name;
    } else {
        joints->n_against += edges[i].name < found[i].mate->name;
        joints->first_against = patch < joints->first_against ? patch : joints->first_against;
    }
}

bool cage_joints_find(struct cage_joints *joints, const struct cage *cage)
{
    size_t most = 4 * cage->n_patches;
    *joints = (struct cage_joints){.across = malloc((cage->n_patches + 1) * sizeof *joints->across),
                                   .collapsed = calloc(cage->n_patches + 1, 1),
                                   .first_against = UINT32_MAX};
    struct edge *edges = malloc((most + 1) * sizeof *edges);
    struct found *found = calloc(most + 1, sizeof *found);
    bool ok = joints->across && joints->collapsed && edges && found;
    if (ok) {
        double distance = tolerance_of(cage);
        size_t n = list_edges(cage, distance, joints->collapsed, edges);
        match(edges, found, n, distance);
        memset(joints->across, 0xff, cage->n_patches * sizeof *joints->across);
        for (size_t i = 0; i < n; i++)
            settle(joints, edges, found, i);
    } else {
        cage_joints_finish(joints);
    }
    free(edges);
    free(found);
    return ok;
}

size_t cage_joints_bytes(size_t n_patches)
{
    const struct cage_joints *joints;
    return n_patches * (4 * (sizeof(struct edge) + sizeof(struct found)) + sizeof *joints->across +
                        sizeof *joints->collapsed);
}

void cage_joints_finish(struct cage_joints *joints)
{
    free(joints->across);
    free(joints->collapsed);
    *joints = (struct cage_joints){0};
}
