#include "tests/oracle/tables.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tests/oracle/fault.h"

namespace
{

/* The four uniform cubic B-splines at t: values, first and second derivatives. */
struct cubic {
    double value[4], first[4], second[4];

    explicit cubic(double t)
    {
        double s = 1 - t;
        const double b[4] = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                             (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
        const double d[4] = {-s * s / 2, (3 * t * t - 4 * t) / 2, -(3 * s * s - 4 * s) / 2,
                             t * t / 2};
        const double dd[4] = {s, 3 * t - 2, 3 * s - 2, t};
        std::copy_n(b, 4, value);
        std::copy_n(d, 4, first);
        std::copy_n(dd, 4, second);
    }
};

/* The patch of the 16 texels index(i, j), i along s and j along t in 0..3, times the first texel.
 */
template <typename Index>
surface_point evaluate_patch(const float (*texels)[3], double s, double t, Index index)
{
    cubic x(s), y(t);
    double scale = texels[0][0];
    surface_point out;
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            const float *texel = texels[index(i, j)];
            vec3 p = scale * vec3{texel[0], texel[1], texel[2]};
            out.p = out.p + (x.value[i] * y.value[j]) * p;
            out.du = out.du + (x.first[i] * y.value[j]) * p;
            out.dv = out.dv + (x.value[i] * y.first[j]) * p;
            out.duu = out.duu + (x.second[i] * y.value[j]) * p;
            out.duv = out.duv + (x.first[i] * y.first[j]) * p;
            out.dvv = out.dvv + (x.value[i] * y.second[j]) * p;
        }
    return out;
}

vec3 rotate(const float (*head)[3], vec3 p)
{
    vec3 axis = {head[0][0], head[0][1], head[0][2]};
    vec3 twice = 2.0 * cross(axis, p);
    return p + (double)head[1][0] * twice + cross(axis, twice);
}

/* Inside the last ring only the vertex itself is known. */
bool evaluate_corner(const float (*texels)[3], int levels, double a, double b, surface_point *out)
{
    int exponent;
    std::frexp(std::fmax(a, b), &exponent); /* max(a,b) in [2^(exponent-1), 2^exponent) */
    int n = std::max(1, 1 - exponent);
    if (!(std::fmax(a, b) > 0) || n > levels)
        return false;
    *out = evaluate_ring(texels, n, a, b);
    for (vec3 *v : {&out->p, &out->du, &out->dv, &out->duu, &out->duv, &out->dvv})
        *v = rotate(texels, *v);
    return true;
}

/* Patch n = 1..levels covers 2^-n <= b <= 2^(1-n), patch levels + 1 the rest. */
surface_point evaluate_strip(const float (*texels)[3], int levels, double a, double b)
{
    int n = 1;
    while (n <= levels && std::ldexp(b, n) < 1)
        n++;
    double t = n <= levels ? std::ldexp(b, n) - 1 : std::ldexp(b, levels);
    const float(*patch)[3] = texels + LIMIT_PATCH_TEXELS * (n - 1);
    return evaluate_patch(patch, a, t, [](int i, int j) { return 1 + 4 * j + i; });
}

/* (u,v) to the local (a,b) of the corner that many steps on. */
void turn(unsigned steps, double u, double v, double *a, double *b)
{
    const double as[4] = {u, v, 1 - u, 1 - v}, bs[4] = {v, 1 - u, 1 - v, u};
    *a = as[steps & 3];
    *b = bs[steps & 3];
}

/* (u,v) are seen from `corner` of the node. */
bool evaluate_leaf(const limit_tables &tables, const limit_node &node, unsigned corner, double u,
                   double v, surface_point *out)
{
    double a, b;
    turn(node.rotation - corner, u, v, &a, &b);
    const float(*texels)[3] = tables.points + node.first;
    if (node.kind == LIMIT_HOLE)
        return false;
    if (node.kind == LIMIT_REGULAR)
        *out = evaluate_patch(texels, a, b, [](int i, int j) { return 1 + 4 * j + i; });
    else if (node.kind == LIMIT_STRIP)
        *out = evaluate_strip(texels, node.levels, a, b);
    else if (!evaluate_corner(texels, node.levels & ~LIMIT_NO_NORMAL, a, b, out))
        return false;
    out->p = out->p + vec3{node.origin[0], node.origin[1], node.origin[2]};
    return true;
}

/* From a node down. (a,b) are seen from `corner` of it, as they are from that of every child. */
bool descend(const limit_tables &tables, const limit_node *node, unsigned corner, double a,
             double b, surface_point *out)
{
    uint32_t face = node->face, x = node->cell & 0xffff, y = node->cell >> 16;
    for (; node->kind == LIMIT_SPLIT;) {
        bool far_a = a >= 0.5, far_b = b >= 0.5;
        unsigned child = (corner + (far_a ? (far_b ? 2 : 1) : (far_b ? 3 : 0))) & 3;
        node = &tables.nodes[node->first + child];
        x = 2 * x + (child == 1 || child == 2);
        y = 2 * y + (child >= 2);
        a = 2 * a - far_a;
        b = 2 * b - far_b;
    }
    if (node->face != face || node->cell != (x | y << 16))
        throw std::runtime_error("a node's face or cell is not where the descent led");
    return evaluate_leaf(tables, *node, corner, a, b, out);
}

/* Puts in the faults that FAKE_FAULTS names, for self_test.sh. */
void break_tables(limit_tables *t)
{
    bool opened = false;
    for (size_t k = 0; k < t->n_nodes; k++) {
        limit_node *node = &t->nodes[k];
        if (node->kind == LIMIT_SPLIT)
            continue;
        float(*texels)[3] = t->points + node->first;
        float off = k % 2 ? 1e-4f : -1e-4f; /* else neighbours would agree in their fault */
        if (has_fault("point"))
            texels[node->kind == LIMIT_CORNER ? LIMIT_CORNER_HEAD + 6 : 6][0] += off;
        if (has_fault("frame") && node->kind == LIMIT_CORNER)
            texels[0][0] += off;
        if (has_fault("deep") && node->kind == LIMIT_CORNER)
            texels[LIMIT_CORNER_TEXELS(25)][0] *= 1.001f;
        if (has_fault("hole") && !opened)
            node->kind = LIMIT_HOLE;
        opened = true;
    }
    if (has_fault("neighbour"))
        std::swap(t->adjacency[0].across[0], t->adjacency[0].across[1]);
}

} // namespace

surface_point evaluate_ring(const float (*texels)[3], int n, double a, double b)
{
    const float(*level)[3] = texels + LIMIT_CORNER_TEXELS(n - 1);
    double s = std::ldexp(a, n), t = std::ldexp(b, n);
    int i0 = s >= 1, j0 = t >= 1; /* first column and row of the 5x5 grid */
    return evaluate_patch(level, s - i0, t - j0,
                          [&](int i, int j) { return 5 * (j + j0) + (i + i0); });
}

curvatures principal_curvatures(const surface_point &s)
{
    vec3 n = s.normal();
    double e = dot(s.du, s.du), f = dot(s.du, s.dv), g = dot(s.dv, s.dv), w = e * g - f * f;
    double l = dot(s.duu, n), m = dot(s.duv, n), k = dot(s.dvv, n);
    double mean = (e * k - 2 * f * m + g * l) / (2 * w), gauss = (l * k - m * m) / w;
    double half = std::sqrt(std::fmax(mean * mean - gauss, 0));
    return {mean - half, mean + half};
}

table_evaluator::table_evaluator(const cage &cage)
{
    error error;
    limit_plan *plan = limit_plan_create(&cage, &error);
    if (!plan)
        throw std::runtime_error(error.text);
    bool built = limit_tables_init(&tables, plan, &error) &&
                 limit_build_faces(&tables, plan, 0, tables.n_faces, &error);
    limit_plan_destroy(plan);
    if (!built)
        throw std::runtime_error(error.text);
    break_tables(&tables);
}

table_evaluator::~table_evaluator()
{
    limit_tables_finish(&tables);
}

bool table_evaluator::evaluate(uint32_t face, double u, double v, surface_point *out) const
{
    return descend(tables, &tables.nodes[face], 0, u, v, out);
}

bool table_evaluator::evaluate(const place &at, surface_point *out) const
{
    return descend(tables, &tables.nodes[at.face], at.corner, at.a, at.b, out);
}

bool table_evaluator::evaluate_node(uint32_t node, double u, double v, surface_point *out) const
{
    return descend(tables, &tables.nodes[node], 0, u, v, out);
}
