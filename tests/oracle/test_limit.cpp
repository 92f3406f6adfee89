/* test_limit MODEL...: the tables of server/surface, evaluated on the CPU as
 * server/surface/tables.h describes, against libosd in double precision at random (face, u, v),
 * without GPU or daemon. Then what libosd cannot judge: that the rings of an extraordinary vertex
 * join, down to the deepest. */
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracle/limit_samples.h"
#include "tests/oracle/model.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"

namespace
{

const double max_normal_p999_rad = 2e-6, max_position_p999 = 1e-6; /* as in exactness.cpp */
const double max_seam_rad = 5e-6; /* both sides are stored in single precision */
const double max_seam = 2e-6;     /* of the size of the ring */
const size_t n_samples = 40000, min_samples = 1000;

struct figures {
    limit_samples samples;
    std::vector<double> seam_rad, seam;
    size_t adjacency = 0;
};

/* On the seam max(a,b) = 2^-n, ring n (outside) and ring n + 1 (inside) must give the same
 * surface. */
void compare_seams(const table_evaluator &tables, figures *f)
{
    for (size_t k = 0; k < tables.tables.n_nodes; k++) {
        const limit_node &node = tables.tables.nodes[k];
        if (node.kind != LIMIT_CORNER)
            continue;
        for (int n = 1; n < int(node.levels & ~LIMIT_NO_NORMAL); n++)
            for (int side = 0; side < 6; side++) {
                double reach = std::ldexp(1.0, -n), other = reach * (side % 3) / 2.0;
                double a = side < 3 ? reach : other, b = side < 3 ? other : reach;
                /* The inner ring's outer border is at s = 2, the upper end of its last patch. */
                surface_point outer = evaluate_ring(tables.tables, node, n, a, b);
                surface_point inner = evaluate_ring(tables.tables, node, n + 1, a, b);
                double size = length(outer.du) + length(outer.dv);
                f->seam.push_back(length(outer.p - inner.p) / size);
                vec3 normal = cross(outer.du, outer.dv);
                if (length(normal) > 1e-6 * size * size) /* else it is a fold: has_normal() */
                    f->seam_rad.push_back(angle(normal, cross(inner.du, inner.dv)));
            }
    }
}

/* Edges of Ptex faces that no other face shares, determined from the cage alone. */
size_t count_open_edges(const cage &cage)
{
    /* in the direction of the winding, and against it */
    std::map<std::pair<uint32_t, uint32_t>, std::pair<int, int>> uses;
    auto each_edge = [&](auto action) {
        for (size_t f = 0; f < cage.n_faces; f++) {
            uint32_t first = cage.face_start[f], end = cage.face_start[f + 1];
            for (uint32_t c = first; c < end; c++) {
                uint32_t a = cage.face_vertex[c];
                uint32_t b = cage.face_vertex[c + 1 == end ? first : c + 1];
                action(std::make_pair(std::min(a, b), std::max(a, b)), a < b, end - first);
            }
        }
    };
    each_edge([&](std::pair<uint32_t, uint32_t> edge, bool forward, uint32_t) {
        forward ? uses[edge].first++ : uses[edge].second++;
    });
    size_t open = 0;
    each_edge([&](std::pair<uint32_t, uint32_t> edge, bool, uint32_t sides) {
        if (uses[edge] != std::make_pair(1, 1))
            open += sides == 4 ? 1 : 2;
    });
    return open;
}

/* The point at `along` (0 to 1) of edge e of a face, from corner e to corner e + 1. */
bool edge_point(const osd_oracle &oracle, uint32_t face, uint32_t e, double along, vec3 *p)
{
    const double us[4] = {along, 1, 1 - along, 0}, vs[4] = {0, along, 1, 1 - along};
    return oracle.evaluate(face, us[e], vs[e], p);
}

/* For each Ptex face, whether it is a whole quad of the cage and not a part of an n-gon. */
std::vector<bool> find_quads(const cage &cage)
{
    std::vector<bool> quads;
    for (size_t f = 0; f < cage.n_faces; f++) {
        size_t sides = cage.face_start[f + 1] - cage.face_start[f];
        quads.insert(quads.end(), sides == 4 ? 1 : sides, sides == 4);
    }
    return quads;
}

/* Neighbours refer to each other, and have the same points on their common edge. A quad beside an
 * n-gon has two Ptex faces across an edge and may refer to either. */
bool is_neighbour(const model &model, const limit_tables &t, const std::vector<bool> &quads,
                  uint32_t face, uint32_t e)
{
    uint32_t across = t.adjacency[face].across[e], other = across >> 2;
    if (other >= t.n_faces)
        return false;
    bool mutual = t.adjacency[other].across[across & 3] == (face << 2 | e);
    if (quads[face] && !quads[other])
        return mutual; /* positions are compared when the n-gon's face is visited */
    bool whole = quads[face] == quads[other];
    if (whole && !mutual)
        return false;
    double from_end = whole ? 0.3 : e == 0 ? 0.15 : 0.65;
    vec3 here, there;
    if (!edge_point(*model.oracle, face, e, 0.3, &here) ||
        !edge_point(*model.oracle, other, across & 3, 1 - from_end, &there))
        return true; /* one side has no surface, so there is nothing to compare */
    return length(here - there) <= 1e-9 * model.diagonal();
}

void compare_adjacency(const model &model, const table_evaluator &tables, figures *f)
{
    size_t open = 0, expected = count_open_edges(*model.cage);
    std::vector<bool> quads = find_quads(*model.cage);
    const limit_tables &t = tables.tables;
    for (uint32_t face = 0; face < t.n_faces; face++)
        for (uint32_t e = 0; e < 4; e++) {
            if (t.adjacency[face].across[e] == LIMIT_NO_FACE)
                open++;
            else
                f->adjacency += !is_neighbour(model, t, quads, face, e);
        }
    f->adjacency += open > expected ? open - expected : expected - open;
}

void judge(const model &model, verdict *verdict)
{
    std::string what = model.name + ": ";
    figures f;
    try {
        table_evaluator tables(*model.cage);
        if (!verdict->check(tables.tables.n_faces == model.oracle->n_ptex_faces(),
                            what + "the number of Ptex faces is not libosd's"))
            return;
        f.samples = compare_limit(*model.oracle, tables, n_samples, 20040617);
        compare_seams(tables, &f);
        if (!model.oracle->non_manifold())
            compare_adjacency(model, tables, &f);
    } catch (const std::exception &failure) {
        verdict->check(false, what + failure.what());
        return;
    }
    limit_samples &at = f.samples;
    double n999 = quantile(at.normal_rad, 0.999), diagonal = model.diagonal();
    double p999 = quantile(at.position, 0.999) / diagonal;
    double seam_rad = quantile(f.seam_rad, 0.999), seam = quantile(f.seam, 0.999);
    std::printf("%-28s %6zu | %7.1e %7.1e %7.1e | %7.1e %7.1e | %8zu %7.1e %7.1e\n",
                model.name.c_str(), at.normal_rad.size(), quantile(at.normal_rad, 0.5), n999,
                quantile(at.normal_rad, 1), p999, quantile(at.position, 1) / diagonal,
                f.seam.size(), seam, seam_rad);
    verdict->check(at.normal_rad.size() > min_samples, what + "too few places compared");
    verdict->check(at.presence == 0,
                   what + std::to_string(at.presence) + " places where only one has a surface");
    verdict->check(f.adjacency == 0, what + std::to_string(f.adjacency) + " wrong neighbours");
    verdict->at_most(n999, max_normal_p999_rad, what + "normal p99.9 (rad)");
    verdict->at_most(p999, max_position_p999, what + "position p99.9 (diagonals)");
    verdict->at_most(seam_rad, max_seam_rad, what + "normals across ring seams p99.9 (rad)");
    verdict->at_most(seam, max_seam, what + "gap at ring seams p99.9 (rings)");
}

/* With the file's boundary mode; an open cage in the other boundary modes as well. */
void judge_file(const std::string &path, verdict *verdict)
{
    model as_read = read_model(path);
    judge(as_read, verdict);
    if (count_open_edges(*as_read.cage) == 0)
        return;
    static const char *const suffix[3] = {" edge only", " edge+corner", " none"};
    for (cage_boundary boundary :
         {CAGE_BOUNDARY_EDGE_ONLY, CAGE_BOUNDARY_EDGE_AND_CORNER, CAGE_BOUNDARY_NONE}) {
        if (boundary == as_read.cage->boundary)
            continue;
        try {
            model other = with_boundary(as_read, boundary);
            other.name = other.name.substr(0, 15) + suffix[boundary];
            judge(other, verdict);
        } catch (const std::exception &no_surface) {
            std::printf("%s\n", no_surface.what());
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 2) {
        std::fprintf(stderr, "usage: test_limit MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-28s %6s | %7s %7s %7s | %7s %7s | %8s %7s %7s\n", "model", "places", "N p50",
                "N p99.9", "N max", "P p99.9", "P max", "seams", "gap", "kink");
    for (const std::string &path : list_models(std::vector<std::string>(argv + 1, argv + argc))) {
        try {
            judge_file(path, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
        std::fflush(stdout);
    }
    return verdict.finish();
}
