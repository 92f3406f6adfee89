#include "server/curves/lines/regions.h"

#include <math.h>

#include "server/surface/evaluate.h"

static void set_levels(const struct limit_tables *tables, uint32_t index, double tolerance,
                       uint8_t *levels)
{
    const struct limit_node *node = &tables->nodes[index];
    for (unsigned k = 0; node->kind == LIMIT_SPLIT && k < 4; k++)
        set_levels(tables, node->first + k, tolerance, levels);
    if (node->kind != LIMIT_CORNER)
        return;
    unsigned level = 1, last = limit_levels(node);
    while (level < last && 2 * (double)limit_level_bound(tables, index, level).radius > tolerance)
        level++;
    levels[index] = (uint8_t)level;
}

void set_levels_of_face(const struct limit_tables *tables, uint32_t face, double tolerance,
                        uint8_t *levels)
{
    set_levels(tables, face, tolerance, levels);
}

/* The crossings on an edge of a face. */
static void gather_side(struct tracer *tracer, uint32_t face, unsigned edge,
                        const struct border_roots *borders, struct root_list *list)
{
    struct border_part parts[2];
    unsigned n = border_parts(tracer->work.tables, face, edge, parts);
    for (unsigned k = 0; k < n; k++) {
        border_key owner = parts[k].owner;
        bool is_own = owner == (face << 2 | edge);
        double length = parts[k].to - parts[k].from;
        for (size_t i = borders->first[owner]; i < borders->first[owner + 1]; i++) {
            struct side_root root = borders->root[i];
            root.t = parts[k].from + length * (is_own ? root.t : 1 - root.t);
            root.node = i;
            root_list_add(&tracer->work, list, root);
        }
    }
    sides_sort(list);
}

/* Divides a region into quarters: what the quarter at corner k has of its sides and of the spokes, which run from the middles
 * of the sides to the centre. */
static void quarter_of(struct sides_work *work, const struct region *region,
                       const struct root_list spoke[4], const struct line_signs *centre, unsigned k,
                       struct region *quarter)
{
    unsigned next = (k + 1) & 3, across = (k + 2) & 3, before = (k + 3) & 3;
    *quarter = (struct region){0};
    root_list_part(work, &region->side[k], 0, 0.5, &quarter->side[k]);
    root_list_part(work, &spoke[k], 0, 1, &quarter->side[next]);
    root_list_reversed(work, &spoke[before], &quarter->side[across]);
    root_list_part(work, &region->side[before], 0.5, 1, &quarter->side[before]);
    quarter->sign[k] = region->sign[k];
    root_list_signs(&region->side[k], &region->sign[k], 0.5, &quarter->sign[next]);
    quarter->sign[across] = *centre;
    root_list_signs(&region->side[before], &region->sign[before], 0.5, &quarter->sign[before]);
}

static void finish_spokes(struct root_list spoke[4])
{
    for (int e = 0; e < 4; e++)
        root_list_finish(&spoke[e]);
}

static void trace_node(struct tracer *tracer, uint32_t index, const struct region *region);

static void trace_split(struct tracer *tracer, uint32_t index, const struct region *region)
{
    struct sides_work *work = &tracer->work;
    const struct limit_node *node = &work->tables->nodes[index];
    struct root_list spoke[4] = {{0}};
    struct line_signs centre = {{0}};
    struct limit_point at;
    double u = ldexp((double)(node->cell & 0xffff) + 0.5, -node->depth);
    double v = ldexp((double)(node->cell >> 16) + 0.5, -node->depth);
    if (limit_evaluate(work->tables, node->face, u, v, &at))
        line_set_signs(work->set, at.s, at.n, &centre);
    for (unsigned e = 0; e < 4; e++) {
        struct line_signs signs;
        root_list_signs(&region->side[e], &region->sign[e], 0.5, &signs);
        sides_find(work, node->first + e, (e + 1) & 3, &signs, &centre, &spoke[e]);
    }
    for (unsigned k = 0; k < 4; k++) {
        struct region quarter;
        quarter_of(work, region, spoke, &centre, k, &quarter);
        trace_node(tracer, node->first + k, &quarter);
        region_finish(&quarter);
    }
    finish_spokes(spoke);
}

/* Traces the three patches of a level, and leaves in *region the square at the vertex. */
static void trace_level(struct tracer *tracer, uint32_t index, int level, struct region *region)
{
    struct sides_work *work = &tracer->work;
    struct root_list spoke[4] = {{0}};
    struct line_signs centre;
    struct limit_point at;
    struct limit_patch patch[4];
    double half = ldexp(1, -level);
    for (unsigned k = 1; k < 4; k++)
        sides_patch(work, index, level, k, &patch[k]);
    patch[2].s = patch[2].t = 0;
    limit_patch_evaluate(work->tables, &patch[2], &at);
    line_set_signs(work->set, at.s, at.n, &centre);
    for (unsigned e = 0; e < 4; e++) {
        struct line_signs signs;
        root_list_signs(&region->side[e], &region->sign[e], 0.5, &signs);
        if (e == 0) /* its patches are those of the next level on one side */
            sides_find_patch(work, &patch[1], 3, 1, 0, &signs, &spoke[0]);
        else
            sides_find_patch(work, &patch[e], (e + 1) & 3, 0, 1, &signs, &spoke[e]);
        sides_agree(work, 1, &signs, &centre, &spoke[e]);
        sides_sort(&spoke[e]);
    }
    struct region quarter;
    for (unsigned k = 1; k < 4; k++) {
        struct patch_place place = {index, k == 3 ? 0 : half, k == 1 ? 0 : half, half, half};
        quarter_of(work, region, spoke, &centre, k, &quarter);
        trace_patch(tracer, &patch[k], &place, &quarter);
        region_finish(&quarter);
    }
    quarter_of(work, region, spoke, &centre, 0, &quarter);
    region_finish(region);
    *region = quarter;
    finish_spokes(spoke);
}

static void trace_corner(struct tracer *tracer, uint32_t index, struct region *region)
{
    int levels = tracer->work.levels[index];
    for (int level = 1; level <= levels; level++)
        trace_level(tracer, index, level, region);
    double rest = ldexp(1, -levels);
    trace_vertex(tracer, &(struct patch_place){index, 0, 0, rest, rest}, region);
}

/* Traces the upper half of a STRIP's region, and leaves in *region the lower half. */
static void trace_band(struct tracer *tracer, uint32_t index, int level, struct region *region)
{
    struct sides_work *work = &tracer->work;
    struct root_list seam = {0}; /* from the middle of side 3 to that of side 1 */
    struct line_signs left, right, signs;
    struct limit_patch patch;
    double low = ldexp(1, -level);
    sides_patch(work, index, level, 0, &patch);
    root_list_signs(&region->side[3], &region->sign[3], 0.5, &left);
    root_list_signs(&region->side[1], &region->sign[1], 0.5, &right);
    signs = left;
    sides_find_patch(work, &patch, 0, 0, 1, &signs, &seam);
    sides_agree(work, 1, &signs, &right, &seam);
    sides_sort(&seam);
    struct region upper = {.sign = {left, right, region->sign[2], region->sign[3]}};
    struct region lower = {.sign = {region->sign[0], region->sign[1], right, left}};
    root_list_part(work, &seam, 0, 1, &upper.side[0]);
    root_list_part(work, &region->side[1], 0.5, 1, &upper.side[1]);
    root_list_part(work, &region->side[2], 0, 1, &upper.side[2]);
    root_list_part(work, &region->side[3], 0, 0.5, &upper.side[3]);
    root_list_part(work, &region->side[0], 0, 1, &lower.side[0]);
    root_list_part(work, &region->side[1], 0, 0.5, &lower.side[1]);
    root_list_reversed(work, &seam, &lower.side[2]);
    root_list_part(work, &region->side[3], 0.5, 1, &lower.side[3]);
    trace_patch(tracer, &patch, &(struct patch_place){index, 0, low, 1, low}, &upper);
    region_finish(&upper);
    root_list_finish(&seam);
    region_finish(region);
    *region = lower;
}

static void trace_strip(struct tracer *tracer, uint32_t index, struct region *region)
{
    int levels = tracer->work.tables->nodes[index].levels;
    struct limit_patch patch;
    for (int level = 1; level <= levels; level++)
        trace_band(tracer, index, level, region);
    sides_patch(&tracer->work, index, levels + 1, 0, &patch);
    trace_patch(tracer, &patch, &(struct patch_place){index, 0, 0, 1, ldexp(1, -levels)}, region);
}

static void trace_node(struct tracer *tracer, uint32_t index, const struct region *region)
{
    const struct limit_node *node = &tracer->work.tables->nodes[index];
    if (node->kind == LIMIT_HOLE || tracer->work.failed)
        return;
    if (node->kind == LIMIT_SPLIT) {
        trace_split(tracer, index, region);
        return;
    }
    struct region local = {0};
    for (unsigned k = 0; k < 4; k++) {
        unsigned cell = (k + node->rotation) & 3;
        local.sign[k] = region->sign[cell];
        root_list_part(&tracer->work, &region->side[cell], 0, 1, &local.side[k]);
    }
    if (node->kind == LIMIT_CORNER) {
        trace_corner(tracer, index, &local);
    } else if (node->kind == LIMIT_STRIP) {
        trace_strip(tracer, index, &local);
    } else {
        struct limit_patch patch;
        sides_patch(&tracer->work, index, 0, 0, &patch);
        trace_patch(tracer, &patch, &(struct patch_place){index, 0, 0, 1, 1}, &local);
    }
    region_finish(&local);
}

void trace_face(struct tracer *tracer, uint32_t face, const struct border_roots *borders)
{
    struct region region = {0};
    tracer->work.next_node = (uint64_t)1 << 63 | (uint64_t)face << 31;
    for (unsigned k = 0; k < 4; k++) {
        region.sign[k] = borders->sign[borders->vertices->number[face << 2 | k]];
        gather_side(tracer, face, k, borders, &region.side[k]);
    }
    trace_node(tracer, face, &region);
    region_finish(&region);
}
