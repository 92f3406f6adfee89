/* test_line_ends [SEED]: lines on random cages (random_cage.h) end nowhere but where they may: where the surface ends or has a
 * sharp crease; at a mark; or where the ray ceases to meet the light, or its place on the light jumps, as at the pole of an azimuth. With a
 * seed only that cage is tested, and its wrong ends are printed. */
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>

#include "tests/oracle/refine_walk.h"
#include "tests/oracle/random_cage.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"

using std::atomic_bool; /* what <stdatomic.h> gives C */
extern "C" {
#include "server/curves/lines/surface_lines.h"
}

namespace
{

const uint64_t first_seed = 1, n_cages = 24;
/* Cages on which lines once ended within the surface: there the normal nearly vanishes, and F made as a polynomial lost its digits. */
const uint64_t found_seeds[] = {52, 58, 123, 127, 146, 273, 285, 306};
const int n_lines = 6;
const double tolerance = 1e-4; /* of the cage's diagonal, for polylines */
/* Curves that end in a mark may be joined with it through an extraordinary vertex. */
const double same_place = 3; /* tolerances */

struct random_numbers {
    std::mt19937_64 source;
    double within(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(source);
    }
    void vector(double size, double out[3])
    {
        for (int k = 0; k < 3; k++)
            out[k] = within(-size, size);
    }
};

/* Lines of a random family and light around a cage. */
std::unique_ptr<line_set> random_lines(random_numbers *random, const limit_tables &tables,
                                       double size)
{
    auto set = std::make_unique<line_set>();
    std::memset(set.get(), 0, sizeof *set);
    while (set->n_lines == 0) {
        lines family = {};
        family.family = (line_family)(random->source() % 5);
        family.has_direction = family.family != LINES_ISOPHOTE || random->source() % 2;
        random->vector(1, family.direction);
        family.eye_kind = random->source() % 2 ? LINE_EYE_POINT : LINE_EYE_DIRECTION;
        random->vector(3 * size, family.eye);
        light light = {};
        light.kind = (light_kind)(random->source() % 4);
        bool is_flat = light.kind == LIGHT_RECTANGLE || light.kind == LIGHT_PLANE;
        random->vector(is_flat ? 2 * size : 0.3 * size, light.centre);
        random->vector(4 * size, light.u);
        random->vector(4 * size, light.v);
        for (int k = 0; k < 3; k++) {
            double middle = 0.5 * (tables.box_min[k] + tables.box_max[k]);
            light.centre[k] += middle;
            family.eye[k] += family.eye_kind == LINE_EYE_POINT ? middle : 0;
        }
        light.pattern.rotation_deg = random->source() % 4 ? 0 : 90;
        light.one_sided = is_flat && random->source() % 4 == 0;
        line_map map;
        line_map_init(&map, &family, &light);
        for (int i = 0; i < n_lines; i++)
            line_set_add(set.get(), &map, 0, (i + random->within(0.2, 0.8)) / n_lines);
    }
    return set;
}

double distance(vec a, vec b)
{
    return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                     (a.z - b.z) * (a.z - b.z));
}

/* What was traced on one cage. */
struct traced_cage {
    const limit_tables &tables;
    const line_set &set;
    surface_lines_result result;
    double near; /* world units */
};

const traced_point &end_of(const traced_cage &all, const curve &curve, int end)
{
    return all.result.curves->point[curve.first + (end ? curve.n - 1 : 0)];
}

bool is_marked(const traced_cage &all, uint32_t line, vec at)
{
    for (size_t k = 0; k < all.result.n_marks; k++)
        if (all.result.marks[k].line == line && distance(all.result.marks[k].at.p, at) < all.near)
            return true;
    return false;
}

bool is_at_border(const traced_cage &all, const traced_point &at)
{
    const double off[4] = {at.v, 1 - at.u, 1 - at.v, at.u};
    for (unsigned e = 0; e < 4; e++) {
        bool ends = all.tables.adjacency[at.face].across[e] == LIMIT_NO_FACE ||
                    (all.tables.nodes[at.face].borders >> (4 * e) & 15) == LIMIT_BORDER_SHARP;
        if (ends && off[e] < 1e-9)
            return true;
    }
    return false;
}

/* The place on the light is not known, or jumps, within `radius` of a point in the face's parameters. */
bool breaks_nearby(const traced_cage &all, uint32_t line, const traced_point &at, double radius)
{
    const line_field *field = line_set_field(&all.set, line);
    for (int k = 0; k < 64; k++) {
        double angle = k * 0.1, u = at.u + radius * std::cos(angle),
               v = at.v + radius * std::sin(angle);
        limit_point point;
        if (!limit_evaluate(&all.tables, at.face, std::fmin(std::fmax(u, 0), 1),
                            std::fmin(std::fmax(v, 0), 1), &point))
            continue;
        double residual = field_residual(field, &all.set.line[line], point.s, point.n);
        if (!(std::fabs(residual) < 0.05))
            return true;
    }
    return false;
}

struct figures {
    size_t n_cages = 0, n_curves = 0, n_ends = 0, n_marks = 0, n_wrong = 0;
};

void judge(uint64_t seed, bool print, figures *f, verdict *verdict)
{
    random_cage made = make_random_cage(seed);
    solid_cage solid(made.parts);
    table_evaluator evaluator(solid.cage);
    random_numbers random{std::mt19937_64(seed)};
    double size = cage_diagonal(solid.cage);
    auto set = random_lines(&random, evaluator.tables, size);
    error error = {};
    surface_lines *lines = surface_lines_create(&evaluator.tables, set.get(), tolerance * size,
                                                (size_t)1 << 30, &error);
    if (!lines || !computation_run(surface_lines_computation(lines), &error))
        throw std::runtime_error(error.text);
    traced_cage all = {evaluator.tables, *set, surface_lines_get(lines),
                       same_place * tolerance * size};
    size_t wrong = 0;
    for (size_t c = 0; c < all.result.curves->n_curves; c++) {
        const curve &curve = all.result.curves->curve[c];
        for (int e = 0; e < 2 && !curve.closed; e++) {
            const traced_point &at = end_of(all, curve, e);
            f->n_ends++;
            if (is_marked(all, curve.line, at.p) || is_at_border(all, at) ||
                breaks_nearby(all, curve.line, at, 1e-5))
                continue;
            wrong++;
            if (print)
                std::printf("line %u, end %d of curve %zu: face %u, %.9g %.9g, residual %.3g\n",
                            curve.line, e, c, at.face, at.u, at.v, at.residual);
        }
    }
    verdict->check(wrong == 0, "seed " + std::to_string(seed) + " (" + made.story +
                                   "): " + std::to_string(wrong) + " wrong ends");
    f->n_cages++;
    f->n_curves += all.result.curves->n_curves;
    f->n_marks += all.result.n_marks;
    f->n_wrong += wrong;
    computation_destroy(surface_lines_computation(lines));
}

} // namespace

int main(int argc, char **argv)
{
    verdict verdict;
    figures f;
    if (argc > 1) {
        judge(std::strtoull(argv[1], nullptr, 10), true, &f, &verdict);
    } else {
        for (uint64_t seed = first_seed; seed < first_seed + n_cages; seed++)
            judge(seed, false, &f, &verdict);
        for (uint64_t seed : found_seeds)
            judge(seed, false, &f, &verdict);
    }
    std::printf("%zu cages, %zu curves, %zu ends, %zu marks, %zu wrong ends\n", f.n_cages,
                f.n_curves, f.n_ends, f.n_marks, f.n_wrong);
    if (argc <= 1) {
        verdict.check(f.n_ends > 2000, "too few ends");
        verdict.check(f.n_marks < f.n_ends / 4, "too many marks");
    }
    return verdict.finish();
}
