/* test_refine MODEL...: sheen's refinement of every quad, by its rings, against libosd's uniform
 * refinement of the cage: every vertex of levels 1 to 4. */
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/model.h"
#include "tests/oracle/refine_walk.h"
#include "tests/oracle/verdict.h"

namespace
{

const int n_levels = 4;
const double max_distance = 1e-12; /* of the bounding diagonal of the cage */

void judge(const std::string &path, verdict *verdict)
{
    std::shared_ptr<const cage> cage = read_cage_file(path);
    refine_walk walk = walk_levels(*cage, n_levels);
    std::string name = path.substr(path.rfind('/') + 1);
    std::printf("%-28s %8zu |", name.c_str(), walk.n_faces[n_levels]);
    double diagonal = cage_diagonal(*cage), worst = 0;
    for (int level = 1; level <= n_levels; level++) {
        double relative = walk.distance[(size_t)level] / diagonal;
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
            verdict.check(false, path + ": " + failure.what());
        }
        std::fflush(stdout);
    }
    return verdict.finish();
}
