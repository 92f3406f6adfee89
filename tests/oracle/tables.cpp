#include "tests/oracle/tables.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "tests/oracle/fault.h"

namespace
{

vec3 from_vec(const vec &v)
{
    return {v.x, v.y, v.z};
}

surface_point from_patch(const limit_tables &tables, const limit_patch &patch)
{
    limit_point p;
    limit_patch_evaluate(&tables, &patch, &p);
    return {from_vec(p.s), from_vec(p.su), from_vec(p.sv), p.luu, p.luv, p.lvv};
}

/* Expects that every child is the quarter of its parent that its index says. Otherwise a descent
 * would end at another place of the surface. */
void check_cells(const limit_tables &tables)
{
    for (size_t k = 0; k < tables.n_nodes; k++) {
        const limit_node &node = tables.nodes[k];
        for (uint32_t i = 0; i < 4 && node.kind == LIMIT_SPLIT; i++) {
            const limit_node &child = tables.nodes[node.first + i];
            uint32_t x = 2 * (node.cell & 0xffff) + (i == 1 || i == 2);
            uint32_t y = 2 * (node.cell >> 16) + (i >= 2);
            if (child.face != node.face || child.cell != (x | y << 16) ||
                child.depth != node.depth + 1)
                throw std::runtime_error("a node's face, cell or depth is not its parent's");
        }
        if (k < tables.n_faces && (node.face != k || node.cell != 0 || node.depth != 0))
            throw std::runtime_error("a root's face or cell is not its own");
    }
}

/* Applies the faults that FAKE_FAULTS names, for self_test.sh. */
void break_tables(limit_tables *t)
{
    bool opened = false;
    for (size_t k = 0; k < t->n_nodes; k++) {
        limit_node *node = &t->nodes[k];
        if (node->kind == LIMIT_SPLIT)
            continue;
        float(*texels)[4] = t->texels + node->first;
        int levels = node->levels & ~(int)LIMIT_NO_NORMAL;
        /* the fault differs from node to node, since equal faults in neighbours would agree */
        float off = k % 2 ? 1e-4f : -1e-4f;
        if (has_fault("point"))
            texels[node->kind == LIMIT_CORNER ? LIMIT_CORNER_HEAD(levels) + 6 : 6][0] += off;
        if (has_fault("frame") && node->kind == LIMIT_CORNER)
            texels[0][0] = t->heads[k].frame[0] += off;
        if (has_fault("deep") && node->kind == LIMIT_CORNER)
            texels[1 + 25 / 4][25 % 4] *= 1.001f;
        if (has_fault("hole") && !opened)
            node->kind = LIMIT_HOLE;
        opened = true;
    }
    if (has_fault("neighbour"))
        std::swap(t->adjacency[0].across[0], t->adjacency[0].across[1]);
}

} // namespace

surface_point evaluate_ring(const limit_tables &tables, const limit_node &node, int n, double a,
                            double b)
{
    limit_patch patch;
    limit_patch_of_level(&patch, &tables, &node, n, a, b);
    return from_patch(tables, patch);
}

curvatures principal_curvatures(const surface_point &s)
{
    double e = dot(s.du, s.du), f = dot(s.du, s.dv), g = dot(s.dv, s.dv);
    vec3 m = cross(s.du, s.dv); /* e g - f f would cancel if du and dv are nearly parallel */
    double w = dot(m, m);
    double mean = (e * s.lvv - 2 * f * s.luv + g * s.luu) / (2 * w);
    double gauss = (s.luu * s.lvv - s.luv * s.luv) / w;
    double half = std::sqrt(std::fmax(mean * mean - gauss, 0));
    return {mean - half, mean + half};
}

curvatures principal_curvatures(const osd_sample &sample)
{
    vec3 n = sample.normal();
    return principal_curvatures(surface_point{sample.p, sample.du, sample.dv, dot(sample.duu, n),
                                              dot(sample.duv, n), dot(sample.dvv, n)});
}

table_evaluator::table_evaluator(const cage &cage)
{
    error error;
    limit_plan *plan = limit_plan_create(&cage, NULL, &error);
    if (!plan)
        throw std::runtime_error(error.text);
    bool built = limit_tables_init(&tables, limit_plan_size(plan), &error) &&
                 limit_build_faces(&tables, plan, 0, tables.n_faces, NULL, &error);
    limit_plan_destroy(plan);
    if (!built)
        throw std::runtime_error(error.text);
    check_cells(tables);
    break_tables(&tables);
}

table_evaluator::~table_evaluator()
{
    limit_tables_finish(&tables);
}

bool table_evaluator::evaluate(const limit_place &at, surface_point *out) const
{
    limit_patch patch;
    if (!limit_patch_find(&tables, &at, &patch) || patch.is_vertex)
        return false;
    *out = from_patch(tables, patch);
    return true;
}

bool table_evaluator::evaluate(uint32_t face, double u, double v, surface_point *out) const
{
    return evaluate(limit_place{face, 0, u, v}, out);
}

bool table_evaluator::evaluate(const place &at, surface_point *out) const
{
    return evaluate(limit_place{at.face, at.corner, at.a, at.b}, out);
}

bool table_evaluator::evaluate_node(uint32_t node, double u, double v, surface_point *out) const
{
    return evaluate(limit_place{node, 0, u, v}, out);
}
