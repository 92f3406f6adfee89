#include "tests/oracle/osd_refiner.h"

#include <stdexcept>
#include <vector>

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace
{

Sdc::Options scheme_options(const cage &cage)
{
    Sdc::Options options;
    switch (cage.boundary) {
    case CAGE_BOUNDARY_EDGE_ONLY:
        options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
        break;
    case CAGE_BOUNDARY_EDGE_AND_CORNER:
        options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
        break;
    case CAGE_BOUNDARY_NONE:
        options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_NONE);
        break;
    }
    options.SetCreasingMethod(cage.chaikin ? Sdc::Options::CREASE_CHAIKIN
                                           : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(cage.smooth_triangles ? Sdc::Options::TRI_SUB_SMOOTH
                                                         : Sdc::Options::TRI_SUB_CATMARK);
    return options;
}

} // namespace

std::unique_ptr<Far::TopologyRefiner> make_refiner(const cage &cage)
{
    if (cage.scheme != CAGE_SCHEME_CATMULL_CLARK)
        throw std::runtime_error("the oracle evaluates Catmull-Clark cages only");
    size_t n_corners = cage.face_start[cage.n_faces];
    std::vector<int> sizes(cage.n_faces), corners(n_corners);
    for (size_t f = 0; f < cage.n_faces; f++)
        sizes[f] = (int)(cage.face_start[f + 1] - cage.face_start[f]);
    for (size_t i = 0; i < n_corners; i++)
        corners[i] = (int)cage.face_vertex[i];
    std::vector<int> crease_ends, corner_vertices, holes;
    std::vector<float> crease_sharpness, corner_sharpness;
    for (size_t i = 0; i < cage.n_creases; i++) {
        crease_ends.push_back((int)cage.crease[i].vertex[0]);
        crease_ends.push_back((int)cage.crease[i].vertex[1]);
        crease_sharpness.push_back(cage.crease[i].sharpness);
    }
    for (size_t i = 0; i < cage.n_corners; i++) {
        corner_vertices.push_back((int)cage.corner[i].vertex);
        corner_sharpness.push_back(cage.corner[i].sharpness);
    }
    for (size_t i = 0; i < cage.n_holes; i++)
        holes.push_back((int)cage.hole[i]);

    Far::TopologyDescriptor d;
    d.numVertices = (int)cage.n_vertices;
    d.numFaces = (int)cage.n_faces;
    d.numVertsPerFace = sizes.data();
    d.vertIndicesPerFace = corners.data();
    d.numCreases = (int)cage.n_creases;
    d.creaseVertexIndexPairs = crease_ends.data();
    d.creaseWeights = crease_sharpness.data();
    d.numCorners = (int)cage.n_corners;
    d.cornerVertexIndices = corner_vertices.data();
    d.cornerWeights = corner_sharpness.data();
    d.numHoles = (int)cage.n_holes;
    d.holeIndices = holes.data();
    using factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    factory::Options options(Sdc::SCHEME_CATMARK, scheme_options(cage));
    std::unique_ptr<Far::TopologyRefiner> refiner(factory::Create(d, options));
    if (!refiner)
        throw std::runtime_error("libosd refuses the cage's topology");
    return refiner;
}
