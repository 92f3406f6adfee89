/* test_refine MODEL...: our own refinement of every quad, by its rings, against libosd's uniform
 * refinement of the cage, levels 1 to 4, every vertex. */
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/model.h"
#include "tests/oracle/osd_levels.h"
#include "tests/oracle/verdict.h"

extern "C" {
#include "server/limit/plan.h"
}

namespace
{

const int n_levels = 4;
const double max_distance = 1e-12; /* of the bounding diagonal of the cage */

/* What is compared as both sides are walked down together. */
struct walk {
    const limit_plan *plan;
    const osd_levels *truth;
    struct arena arena;
    struct shared_rings rings;
    double distance[n_levels + 1] = {};
    size_t n_faces[n_levels + 1] = {};

    /* The quad is face `face` of that level, corner for corner. */
    void compare(const quad &quad, int level, int face)
    {
        n_faces[level]++;
        for (int i = 0; i < 4; i++) {
            const vec &p = quad.corner[i].centre;
            vec3 there = truth->vertex(level, face, i);
            double off = length(vec3{p.x, p.y, p.z} - there);
            distance[level] = off <= distance[level] ? distance[level] : off; /* keeps NaN */
        }
        if (level == n_levels)
            return;
        size_t mark = arena.used;
        struct quad child[4];
        quad_refine(&quad, &arena, child);
        for (int i = 0; i < 4; i++)
            compare(child[i], level + 1, truth->child(level, face, i));
        arena.used = mark;
    }
};

bool touches_ngon(const topology &t, uint32_t corner)
{
    for (int i = 0; i < 4; i++, corner = corner_next(&t, corner))
        if (t.vertex_flags[corner_vertex(&t, corner)] & VERTEX_BY_NGON)
            return true;
    return false;
}

/* From level 0 where all around is a quad, else from level 1. */
void compare_face(walk *walk, uint32_t face)
{
    const topology &t = walk->plan->topology;
    uint32_t first = t.cage->face_start[face], n = face_size(&t, face);
    walk->arena.used = 0;
    if (n == 4 && !touches_ngon(t, first)) {
        quad quad = extract_quad(&t, first, &walk->rings, &walk->arena);
        walk->compare(quad, 0, (int)face);
        return;
    }
    for (uint32_t k = 0; k < n; k++) {
        walk->arena.used = 0;
        quad quad =
            extract_refined_quad(&t, &walk->plan->refined, first + k, &walk->rings, &walk->arena);
        if (n == 4)
            quad = quad_rotated(&quad, (4 - k) & 3); /* a quad's children keep its orientation */
        walk->compare(quad, 1, walk->truth->child(0, (int)face, (int)k));
    }
}

double cage_diagonal(const cage &cage)
{
    double size2 = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < cage.n_vertices; i++) {
            low = std::fmin(low, cage.position[i][k]);
            high = std::fmax(high, cage.position[i][k]);
        }
        size2 += (high - low) * (high - low);
    }
    return std::sqrt(size2);
}

void judge(const std::string &path, verdict *verdict)
{
    std::shared_ptr<const cage> cage = read_cage_file(path);
    osd_levels truth(*cage, n_levels);
    error error;
    std::unique_ptr<limit_plan, void (*)(limit_plan *)> plan(
        limit_plan_create(cage.get(), NULL, &error), limit_plan_destroy);
    if (!plan)
        throw std::runtime_error(path + ": " + error.text);
    walk walk = {};
    walk.plan = plan.get();
    walk.truth = &truth;
    if (!arena_init(&walk.arena, plan->arena_bytes))
        throw std::runtime_error("out of memory");
    shared_rings_init(&walk.rings, cage->face_start[cage->n_faces]);
    for (uint32_t face = 0; face < cage->n_faces; face++)
        compare_face(&walk, face);
    arena_finish(&walk.arena);

    std::string name = path.substr(path.rfind('/') + 1);
    std::printf("%-28s %8zu |", name.c_str(), walk.n_faces[n_levels]);
    double diagonal = cage_diagonal(*cage), worst = 0;
    for (int level = 1; level <= n_levels; level++) {
        double relative = walk.distance[level] / diagonal;
        std::printf(" %7.1e", relative);
        worst = relative <= worst ? worst : relative;
    }
    std::printf("\n");
    verdict->check(walk.n_faces[n_levels] >= (3 * cage->n_faces) << 2 * (n_levels - 1),
                   name + ": too few faces compared");
    verdict->at_most(worst, max_distance, name + ": off libosd's refinement (diagonals)");
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 2) {
        std::fprintf(stderr, "usage: test_refine MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-28s %8s | %31s\n", "model", "faces", "|P - P'| / diagonal, levels 1 to 4");
    for (const std::string &path : list_models(std::vector<std::string>(argv + 1, argv + argc))) {
        try {
            judge(path, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
        std::fflush(stdout);
    }
    return verdict.finish();
}
