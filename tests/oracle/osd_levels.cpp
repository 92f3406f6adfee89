#include "tests/oracle/osd_levels.h"

#include <vector>

#include "tests/oracle/osd_refiner.h"

namespace Far = OpenSubdiv::Far;

struct osd_levels::implementation {
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::vector<std::vector<control_point>> points;
};

osd_levels::osd_levels(const cage &cage, int n_levels) : m(new implementation)
{
    m->refiner = make_refiner(cage);
    Far::TopologyRefiner::UniformOptions options(n_levels);
    options.fullTopologyInLastLevel = true;
    m->refiner->RefineUniform(options);
    m->points.resize((size_t)n_levels + 1);
    for (size_t i = 0; i < cage.n_vertices; i++)
        m->points[0].push_back({{cage.position[i][0], cage.position[i][1], cage.position[i][2]}});
    Far::PrimvarRefinerReal<double> primvar(*m->refiner);
    for (int level = 1; level <= n_levels; level++) {
        std::vector<control_point> &to = m->points[(size_t)level];
        to.resize((size_t)m->refiner->GetLevel(level).GetNumVertices());
        primvar.Interpolate(level, m->points[(size_t)level - 1], to);
    }
}

osd_levels::~osd_levels() = default;

int osd_levels::child(int level, int face, int corner) const
{
    return m->refiner->GetLevel(level).GetFaceChildFaces(face)[corner];
}

vec3 osd_levels::vertex(int level, int face, int corner) const
{
    int v = m->refiner->GetLevel(level).GetFaceVertices(face)[corner];
    return m->points[(size_t)level][(size_t)v].p;
}
