#include "tests/oracle/osd_oracle.h"

#include <climits>
#include <cmath>
#include <stdexcept>

#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/ptexIndices.h>
#include <opensubdiv/far/stencilTable.h>

#include "tests/oracle/osd_refiner.h"

namespace Far = OpenSubdiv::Far;

namespace
{

const int isolation_level = 10;
const int max_patch_points = 20; /* the size of a Gregory patch; every other kind has fewer */

Far::PatchTableFactory::Options patch_options()
{
    Far::PatchTableFactory::Options options(isolation_level);
    options.useSingleCreasePatch = false;
    options.useInfSharpPatch = true;
    options.generateLegacySharpCornerPatches = false;
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    options.SetPatchPrecision<double>();
    return options;
}

/* The points of the cage, then those of every level, then those of the end caps. */
std::vector<control_point> make_points(const cage &cage, const Far::TopologyRefiner &refiner,
                                       const Far::PatchTable &table)
{
    size_t refined = (size_t)refiner.GetNumVerticesTotal();
    std::vector<control_point> points(refined + (size_t)table.GetNumLocalPoints());
    for (size_t i = 0; i < cage.n_vertices; i++)
        points[i].p = {cage.position[i][0], cage.position[i][1], cage.position[i][2]};
    Far::PrimvarRefinerReal<double> primvar(refiner);
    control_point *source = points.data();
    for (int level = 1; level < refiner.GetNumLevels(); level++) {
        control_point *target = source + refiner.GetLevel(level - 1).GetNumVertices();
        primvar.Interpolate(level, source, target);
        source = target;
    }
    if (table.GetNumLocalPoints() > 0)
        table.GetLocalPointStencilTable<double>()->UpdateValues(points.data(),
                                                                points.data() + refined);
    return points;
}

void list_irregular(const Far::TopologyRefiner &refiner, const Far::PtexIndices &ptex,
                    std::vector<osd_irregular> *list)
{
    static const double corner_u[4] = {0, 1, 1, 0}, corner_v[4] = {0, 0, 1, 1};
    const Far::TopologyLevel &base = refiner.GetLevel(0);
    for (int vertex = 0; vertex < base.GetNumVertices(); vertex++) {
        Far::ConstIndexArray faces = base.GetVertexFaces(vertex);
        bool boundary = base.IsVertexBoundary(vertex);
        if (faces.size() == 0 || faces.size() == (boundary ? 2 : 4))
            continue;
        int corner = base.GetVertexFaceLocalIndices(vertex)[0];
        int first = ptex.GetFaceId(faces[0]);
        size_t valence = (size_t)faces.size();
        if (base.GetFaceVertices(faces[0]).size() == 4)
            list->push_back(
                {(uint32_t)first, corner_u[corner], corner_v[corner], valence, boundary});
        else
            list->push_back({(uint32_t)(first + corner), 0, 0, valence, boundary});
    }
    for (int face = 0; face < base.GetNumFaces(); face++) {
        size_t sides = (size_t)base.GetFaceVertices(face).size();
        if (sides != 4)
            list->push_back({(uint32_t)ptex.GetFaceId(face), 1, 1, sides, false});
    }
}

bool is_non_manifold(const Far::TopologyRefiner &refiner)
{
    const Far::TopologyLevel &base = refiner.GetLevel(0);
    for (int e = 0; e < base.GetNumEdges(); e++)
        if (base.IsEdgeNonManifold(e))
            return true;
    for (int v = 0; v < base.GetNumVertices(); v++)
        if (base.IsVertexNonManifold(v))
            return true;
    return false;
}

} // namespace

struct osd_oracle::implementation {
    std::unique_ptr<Far::PatchTable> table;
    std::unique_ptr<Far::PatchMap> map;
    std::vector<control_point> points;
    std::vector<osd_irregular> irregular;
    uint32_t n_ptex_faces = 0;
    bool non_manifold = false;

    const Far::PatchTable::PatchHandle *find(uint32_t face, double u, double v) const
    {
        bool inside = face < n_ptex_faces && u >= 0 && u <= 1 && v >= 0 && v <= 1;
        return inside ? map->FindPatch((int)face, u, v) : nullptr;
    }
};

osd_oracle::osd_oracle(const cage &cage) : m(new implementation)
{
    std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(cage);
    Far::PatchTableFactory::Options options = patch_options();
    Far::PtexIndices ptex(*refiner);
    m->n_ptex_faces = (uint32_t)ptex.GetNumFaces();
    m->non_manifold = is_non_manifold(*refiner);
    list_irregular(*refiner, ptex, &m->irregular);
    refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    m->table.reset(Far::PatchTableFactory::Create(*refiner, options));
    if (!m->table)
        throw std::runtime_error("libosd builds no patch table for the cage");
    m->points = make_points(cage, *refiner, *m->table);
    m->map.reset(new Far::PatchMap(*m->table));
}

osd_oracle::~osd_oracle() = default;

uint32_t osd_oracle::n_ptex_faces() const
{
    return m->n_ptex_faces;
}

bool osd_oracle::non_manifold() const
{
    return m->non_manifold;
}

const std::vector<osd_irregular> &osd_oracle::irregular() const
{
    return m->irregular;
}

bool osd_oracle::evaluate(uint32_t face, double u, double v, osd_sample *sample) const
{
    const Far::PatchTable::PatchHandle *handle = m->find(face, u, v);
    if (!handle)
        return false;
    double w[6][max_patch_points];
    m->table->EvaluateBasis(*handle, u, v, w[0], w[1], w[2], w[3], w[4], w[5]);
    Far::ConstIndexArray indices = m->table->GetPatchVertices(*handle);
    vec3 sum[6];
    for (int i = 0; i < indices.size(); i++)
        for (int k = 0; k < 6; k++)
            sum[k] = sum[k] + w[k][i] * m->points[(size_t)indices[i]].p;
    /* libosd counts the split of an n-gon as a level, so its derivatives are by half of the Ptex
     * face. */
    double h = m->table->GetPatchParam(*handle).NonQuadRoot() ? 0.5 : 1;
    *sample = {sum[0], h * sum[1], h * sum[2], h * h * sum[3], h * h * sum[4], h * h * sum[5]};
    return true;
}

bool osd_oracle::evaluate(uint32_t face, double u, double v, vec3 *position) const
{
    const Far::PatchTable::PatchHandle *handle = m->find(face, u, v);
    if (!handle)
        return false;
    double w[max_patch_points];
    m->table->EvaluateBasis(*handle, u, v, w);
    Far::ConstIndexArray indices = m->table->GetPatchVertices(*handle);
    *position = vec3();
    for (int i = 0; i < indices.size(); i++)
        *position = *position + w[i] * m->points[(size_t)indices[i]].p;
    return true;
}

bool osd_oracle_is_exact(double u, double v)
{
    return std::fmin(u, 1 - u) >= 1.0 / 512 || std::fmin(v, 1 - v) >= 1.0 / 512;
}
