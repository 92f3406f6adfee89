/* test_twin MODEL...: a cage and its twins, which are rotated, renumbered and rewound, have the
 * same surface. Where two faces, or two leaves of one face, meet, there is no gap, and no step in
 * the normal unless a tag asks for it. */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/model.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"

namespace
{

const double max_gap = 1e-7;      /* of the cage's diagonal */
const double max_step_rad = 5e-6; /* of the normal; both sides are in single precision */
const double max_twin_rad = 4e-6; /* twice the error that one table may have */
const int n_places = 20000, n_edge_places = 5, deepest = 20;

struct figures {
    std::vector<double> gap, step_rad;
    size_t presence = 0; /* places where only one of the two has a surface */
};

/* Normals are compared only if both sides have one. */
void compare(const surface_point &a, const surface_point &b, bool smooth, double diagonal,
             figures *f)
{
    f->gap.push_back(length(a.p - b.p) / diagonal);
    if (smooth && a.has_normal() && b.has_normal())
        f->step_rad.push_back(angle(cross(a.du, a.dv), cross(b.du, b.dv)));
}

void report(const char *name, figures *f)
{
    std::printf(" | %s %7zu %7.1e %7.1e %7.1e", name, f->gap.size(), quantile(f->gap, 1),
                quantile(f->step_rad, 0.999), quantile(f->step_rad, 1));
}

void judge_figures(const std::string &what, double max_rad, figures *f, verdict *verdict)
{
    verdict->check(f->presence == 0, what + ": " + std::to_string(f->presence) +
                                         " places where only one has a surface");
    verdict->at_most(quantile(f->gap, 1), max_gap, what + ": gap (diagonals)");
    verdict->at_most(quantile(f->step_rad, 0.999), max_rad, what + ": normal p99.9 (rad)");
}

/* --- twins --- */

struct twin {
    loose_cage cage;
    std::vector<uint32_t> face;  /* the twin's face for each face of the original */
    std::vector<uint32_t> start; /* and the twin's corner that was the original's first */
    bool rewound;
    double axis[3][3]; /* rows of the rotation */
};

vec3 rotated(const double m[3][3], vec3 p)
{
    return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z,
            m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z,
            m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z};
}

void choose_rotation(std::mt19937_64 *random, double m[3][3])
{
    std::normal_distribution<double> normal;
    auto direction = [&] { return vec3{normal(*random), normal(*random), normal(*random)}; };
    vec3 x = normalized(direction()), z = normalized(cross(x, direction())), y = cross(z, x);
    const vec3 rows[3] = {x, y, z};
    for (int i = 0; i < 3; i++) {
        m[i][0] = rows[i].x;
        m[i][1] = rows[i].y;
        m[i][2] = rows[i].z;
    }
}

std::vector<uint32_t> shuffled(size_t n, std::mt19937_64 *random)
{
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), *random);
    return order;
}

twin make_twin(const loose_cage &original, bool rewound, std::mt19937_64 *random)
{
    twin t;
    t.rewound = rewound;
    t.cage = original;
    choose_rotation(random, t.axis);
    std::vector<uint32_t> vertex = shuffled(original.position.size(), random);
    t.face = shuffled(original.faces.size(), random);
    for (size_t i = 0; i < vertex.size(); i++)
        t.cage.position[vertex[i]] = rotated(t.axis, original.position[i]);
    for (size_t f = 0; f < original.faces.size(); f++) {
        std::vector<uint32_t> corners = original.faces[f];
        for (uint32_t &v : corners)
            v = vertex[v];
        if (rewound)
            std::reverse(corners.begin() + 1, corners.end()); /* the first corner remains first */
        uint32_t start = (uint32_t)((*random)() % corners.size());
        std::rotate(corners.rbegin(), corners.rbegin() + start, corners.rend());
        t.start.push_back(start);
        t.cage.faces[t.face[f]] = corners;
    }
    for (cage_crease &c : t.cage.creases)
        c.vertex[0] = vertex[c.vertex[0]], c.vertex[1] = vertex[c.vertex[1]];
    for (cage_corner &c : t.cage.corners)
        c.vertex = vertex[c.vertex];
    for (uint32_t &hole : t.cage.holes)
        hole = t.face[hole];
    return t;
}

place at_corner(const solid_cage &cage, uint32_t face, uint32_t corner, double a, double b)
{
    uint32_t first = cage.first_ptex[face], n = cage.first_ptex[face + 1] - first;
    return n == 1 ? place{first, corner, a, b} : place{first + corner, 0, a, b};
}

figures compare_twin(const loose_cage &loose, const table_evaluator &tables,
                     const solid_cage &original, bool rewound, double diagonal)
{
    std::mt19937_64 random(rewound ? 11 : 7);
    std::uniform_real_distribution<double> unit(0, 1);
    twin t = make_twin(loose, rewound, &random);
    solid_cage other(t.cage);
    table_evaluator other_tables(other.cage);
    figures f;
    for (int i = 0; i < n_places; i++) {
        uint32_t face = (uint32_t)(unit(random) * (double)loose.faces.size());
        uint32_t n = (uint32_t)loose.faces[face].size(), corner = (uint32_t)(unit(random) * n);
        double reach = i % 2 ? std::pow(2.0, -deepest * unit(random)) : 1;
        double a = reach * unit(random), b = reach * unit(random);
        uint32_t there = ((rewound ? n - corner : corner) + t.start[face]) % n;
        surface_point p, q;
        bool has_p = tables.evaluate(at_corner(original, face, corner, a, b), &p);
        bool has_q = other_tables.evaluate(
            at_corner(other, t.face[face], there, rewound ? b : a, rewound ? a : b), &q);
        f.presence += has_p != has_q;
        if (!has_p || !has_q)
            continue;
        for (vec3 *v : {&p.p, &p.du, &p.dv})
            *v = rotated(t.axis, *v);
        if (rewound)
            std::swap(p.du, p.dv);
        compare(p, q, true, diagonal, &f);
    }
    return f;
}

/* --- edges --- */

struct side {
    uint32_t face, corner; /* the edge runs from this corner to the next one */
};

/* The place at `along` of that edge, from its first corner. */
place on_edge(const solid_cage &cage, const loose_cage &loose, side s, double along)
{
    uint32_t n = (uint32_t)loose.faces[s.face].size();
    if (n == 4 || along <= 0.5)
        return at_corner(cage, s.face, s.corner, n == 4 ? along : 2 * along, 0);
    return at_corner(cage, s.face, (s.corner + 1) % n, 0, 2 * (1 - along));
}

using edge_map = std::map<std::pair<uint32_t, uint32_t>, std::vector<side>>;

edge_map find_edges(const loose_cage &loose)
{
    edge_map edges;
    for (uint32_t f = 0; f < loose.faces.size(); f++)
        for (uint32_t c = 0; c < loose.faces[f].size(); c++) {
            uint32_t a = loose.faces[f][c], b = loose.faces[f][(c + 1) % loose.faces[f].size()];
            edges[{std::min(a, b), std::max(a, b)}].push_back({f, c});
        }
    return edges;
}

/* Places on an edge: in its middle part, and near both ends, as deep as tables reach. */
double edge_place(std::mt19937_64 *random)
{
    std::uniform_real_distribution<double> unit(0, 1);
    double near = 0.5 * std::pow(2.0, -deepest * unit(*random) * (unit(*random) < 0.5));
    double along = near * (0.5 + 0.5 * unit(*random));
    return unit(*random) < 0.5 ? along : 1 - along;
}

figures compare_edges(const loose_cage &loose, const solid_cage &cage,
                      const table_evaluator &tables, double diagonal)
{
    std::mt19937_64 random(3);
    edge_map edges = find_edges(loose);
    std::map<std::pair<uint32_t, uint32_t>, float> sharp;
    for (const cage_crease &c : loose.creases)
        sharp[{std::min(c.vertex[0], c.vertex[1]), std::max(c.vertex[0], c.vertex[1])}] =
            c.sharpness;
    figures f;
    for (const auto &edge : edges) {
        const std::vector<side> &s = edge.second;
        if (s.size() != 2 ||
            loose.faces[s[0].face][s[0].corner] == loose.faces[s[1].face][s[1].corner])
            continue; /* the surface ends, more than two faces meet, or the windings disagree */
        auto found = sharp.find(edge.first);
        bool smooth = found == sharp.end() || found->second < CAGE_SHARPNESS_INFINITE;
        for (int i = 0; i < n_edge_places; i++) {
            double along = edge_place(&random);
            surface_point p, q;
            if (tables.evaluate(on_edge(cage, loose, s[0], along), &p) &&
                tables.evaluate(on_edge(cage, loose, s[1], 1 - along), &q))
                compare(p, q, smooth, diagonal, &f);
        }
    }
    return f;
}

/* The four borders inside every split node. The surface is always smooth across them. */
figures compare_leaves(const table_evaluator &tables, double diagonal)
{
    std::mt19937_64 random(5);
    figures f;
    for (uint32_t k = 0; k < tables.tables.n_nodes; k++) {
        const limit_node &node = tables.tables.nodes[k];
        if (node.kind != LIMIT_SPLIT)
            continue;
        for (uint32_t e = 0; e < 4; e++)
            for (int i = 0; i < 2; i++) {
                double along = edge_place(&random);
                bool upright = e == 0 || e == 2; /* child e and the next child are neighbours */
                surface_point p, q;
                uint32_t a = node.first + e, b = node.first + ((e + 1) & 3);
                /* the common border is the far side of child e, and the near side of b */
                double near = e < 2;
                if (tables.evaluate_node(a, upright ? near : along, upright ? along : near, &p) &&
                    tables.evaluate_node(b, upright ? 1 - near : along, upright ? along : 1 - near,
                                         &q))
                    compare(p, q, true, diagonal, &f);
            }
    }
    return f;
}

double diagonal_of(const limit_tables &t)
{
    return length(vec3{t.hull_max[0] - t.hull_min[0], t.hull_max[1] - t.hull_min[1],
                       t.hull_max[2] - t.hull_min[2]});
}

void judge(const std::string &path, verdict *verdict)
{
    loose_cage loose(*read_cage_file(path));
    solid_cage cage(loose);
    table_evaluator tables(cage.cage);
    double diagonal = diagonal_of(tables.tables);
    figures same = compare_twin(loose, tables, cage, false, diagonal);
    figures rewound = compare_twin(loose, tables, cage, true, diagonal);
    figures edges = compare_edges(loose, cage, tables, diagonal);
    figures leaves = compare_leaves(tables, diagonal);
    std::string name = path.substr(path.rfind('/') + 1);
    std::printf("%-28s", name.c_str());
    report("twin", &same);
    report("rewound", &rewound);
    report("edges", &edges);
    report("leaves", &leaves);
    std::printf("\n");
    verdict->check(same.gap.size() > n_places / 4, name + ": too few places compared");
    judge_figures(name + " and its twin", max_twin_rad, &same, verdict);
    judge_figures(name + " and its rewound twin", max_twin_rad, &rewound, verdict);
    judge_figures(name + " at edges", max_step_rad, &edges, verdict);
    judge_figures(name + " between leaves", max_step_rad, &leaves, verdict);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 2) {
        std::fprintf(stderr, "usage: test_twin MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("each: places, gap max (diagonals), normal p99.9 and max (rad)\n");
    for (const std::string &path : list_models(std::vector<std::string>(argv + 1, argv + argc))) {
        try {
            judge(path, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, path + ": " + failure.what());
        }
        std::fflush(stdout);
    }
    return verdict.finish();
}
