#include "server/surface/support.h"

#include <math.h>
#include <stdlib.h>

#include "server/surface/bound.h"
#include "server/surface/evaluate.h"

/* A node is sampled so densely that the surface lies within this share of the box's diagonal from
 * the triangles of the samples. A node smaller than that is one point. */
#define TOLERANCE 1e-3

struct cells {
    double middle[3], half[3]; /* middle and half sides of the box; half is never 0 */
    double reach2[LIMIT_MAX_SUPPORT];
    float point[LIMIT_MAX_SUPPORT][3]; /* valid if reach2 is not 0 */
};

static uint32_t step_of(double x)
{
    double step = 0.5 * (x + 1) * LIMIT_SUPPORT_CELLS;
    return step < 1 ? 0 : step >= LIMIT_SUPPORT_CELLS ? LIMIT_SUPPORT_CELLS - 1 : (uint32_t)step;
}

/* Keeps for each cell the point that is farthest from the middle. Lengths are in units of the box's
 * sides, so that a flat model has as many points on each side as a round one. */
static void add_point(struct cells *cells, struct vec at)
{
    const double world[3] = {at.x, at.y, at.z};
    double p[3], reach2 = 0;
    int side = 0;
    for (int k = 0; k < 3; k++) {
        p[k] = (world[k] - cells->middle[k]) / cells->half[k];
        reach2 += p[k] * p[k];
        side = fabs(p[k]) > fabs(p[side]) ? k : side;
    }
    double largest = fabs(p[side]);
    if (!(largest > 0) || !isfinite(reach2))
        return;
    uint32_t face = 2 * (uint32_t)side + (p[side] < 0);
    uint32_t x = step_of(p[(side + 1) % 3] / largest), y = step_of(p[(side + 2) % 3] / largest);
    uint32_t cell = (face * LIMIT_SUPPORT_CELLS + y) * LIMIT_SUPPORT_CELLS + x;
    if (reach2 <= cells->reach2[cell])
        return;
    cells->reach2[cell] = reach2;
    for (int k = 0; k < 3; k++)
        cells->point[cell][k] = (float)(world[k] - cells->middle[k]);
}

/* The number of steps along each side of a node; 0: it is as small as a point. */
static int steps_of(const struct limit_tables *tables, uint32_t node, double tolerance)
{
    const struct limit_bound *bound = &tables->whole[node];
    if ((double)bound->radius < tolerance)
        return 0;
    double steps = ceil(sqrt((double)bound_bend(bound) / 8 / tolerance));
    return steps < 1 ? 1 : steps > LIMIT_SUPPORT_STEPS ? LIMIT_SUPPORT_STEPS : (int)steps;
}

static void add_node(struct cells *cells, const struct limit_tables *tables, uint32_t node,
                     double tolerance)
{
    if (!limit_has_points(&tables->nodes[node]))
        return;
    const double *origin = tables->nodes[node].origin;
    const struct limit_head *head = &tables->heads[node];
    int steps = steps_of(tables, node, tolerance);
    if (steps == 0)
        add_point(cells, (struct vec){origin[0], origin[1], origin[2]});
    for (int k = 0; steps > 0 && k < 4; k++)
        add_point(cells, (struct vec){origin[0] + (double)head->corner[0][k],
                                      origin[1] + (double)head->corner[1][k],
                                      origin[2] + (double)head->corner[2][k]});
    struct limit_patch patch = {0}; /* so that the points of a level are made once */
    for (int i = 0; steps > 1 && i <= steps; i++)
        for (int j = 0; j <= steps; j++) {
            if (i % steps == 0 && j % steps == 0)
                continue; /* a corner: made from its levels, an extraordinary vertex would cost all of them */
            struct limit_place place = {
                .node = node, .a = (double)i / steps, .b = (double)j / steps};
            struct limit_point point;
            if (!limit_patch_find_again(tables, &place, &patch))
                return;
            limit_patch_evaluate(tables, &patch, &point);
            add_point(cells, point.s);
        }
}

bool limit_find_support(struct limit_tables *tables, const struct limit_watch *watch,
                        struct error *error)
{
    struct cells *cells = calloc(1, sizeof *cells);
    size_t room = limit_support_room(tables);
    double diagonal = 0;
    bool ok = cells && (!room || (tables->support = malloc(room * sizeof *tables->support)));
    if (!ok) {
        free(cells);
        return error_set(error, ERROR_SERVER, "out of memory for the outline of a model");
    }
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, tables->box_max[k] - tables->box_min[k]);
    for (int k = 0; k < 3; k++) {
        double half = 0.5 * (tables->box_max[k] - tables->box_min[k]);
        cells->middle[k] = 0.5 * (tables->box_max[k] + tables->box_min[k]);
        cells->half[k] = fmax(half, fmax(0.05 * diagonal, 1e-300));
    }
    for (size_t i = 0; ok && i < tables->n_nodes; i++) {
        ok = i % 256 || limit_goes_on(watch, error);
        add_node(cells, tables, (uint32_t)i, fmax(TOLERANCE * diagonal, 1e-300));
    }
    for (int i = 0; ok && i < LIMIT_MAX_SUPPORT; i++)
        if (cells->reach2[i] > 0) {
            for (int k = 0; k < 3; k++)
                tables->support[tables->n_support][k] = cells->point[i][k];
            tables->n_support++;
        }
    free(cells);
    return ok;
}
