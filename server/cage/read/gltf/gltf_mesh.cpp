#include "server/cage/read/gltf/gltf_reader.hpp"

#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "server/cage/read/gltf/ngon.h"

namespace gltf
{

namespace
{

/* A morph target whose weight in the file is not 0. */
struct Morph {
    int accessor;
    double weight;

    bool operator<(const Morph &other) const
    {
        return std::tie(accessor, weight) < std::tie(other.accessor, other.weight);
    }
};

constexpr auto COORDINATES = {TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
                              TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_SHORT,
                              TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};

Elements find_positions(Reader &reader, const std::string &where, const char *what, int accessor)
{
    return find_elements(reader, where, what, accessor, TINYGLTF_TYPE_VEC3, COORDINATES,
                         "VEC3 of floats (5126), or of integers of 8 or 16 bits");
}

std::vector<Morph> find_morphs(Reader &reader, const Primitive &primitive,
                               const std::vector<double> &weights)
{
    const auto &targets = primitive.source->targets;
    std::vector<Morph> morphs;
    if (targets.empty())
        return morphs;
    if (!weights.empty() && weights.size() != targets.size()) {
        reader.passed_over.morph_weights = true;
        return morphs;
    }
    bool any = false;
    for (size_t t = 0; t < weights.size(); t++) {
        auto position = targets[t].find("POSITION");
        any |= weights[t] != 0;
        if (weights[t] != 0 && position != targets[t].end())
            morphs.push_back({position->second, weights[t]});
    }
    reader.passed_over.morph_rest |= !any;
    return morphs;
}

void add_positions(Reader &reader, const Primitive &primitive, const Elements &positions,
                   const std::vector<Morph> &morphs, const transform &matrix)
{
    const char *place = primitive.where.c_str();
    std::vector<Elements> targets;
    for (const Morph &morph : morphs) {
        targets.push_back(
            find_positions(reader, primitive.where, "POSITION of a morph target", morph.accessor));
        if (targets.back().count != positions.count)
            reader.refuse("%s: a morph target has %zu vertices, POSITION %zu", place,
                          targets.back().count, positions.count);
    }
    for (size_t v = 0; v < positions.count; v++) {
        double local[3], world[3];
        for (size_t i = 0; i < 3; i++) {
            local[i] = positions.number(v, i);
            for (size_t t = 0; t < targets.size(); t++)
                local[i] += morphs[t].weight * targets[t].number(v, i);
            if (!std::isfinite(local[i]))
                reader.refuse("%s: POSITION %zu is not finite", place, v);
        }
        transform_point(&matrix, local, world);
        for (double coordinate : world)
            if (!std::isfinite(coordinate))
                reader.refuse("%s: POSITION %zu is not finite where a node puts it", place, v);
        reader.need(cage_builder_vertex(reader.builder, world, reader.failure));
    }
}

/* The vertices in the order of the primitive's indices. */
std::vector<uint32_t> read_indices(Reader &reader, const Primitive &primitive)
{
    std::vector<uint32_t> indices;
    if (primitive.source->indices == -1) {
        indices.reserve(primitive.n_vertices);
        for (size_t v = 0; v < primitive.n_vertices; v++)
            indices.push_back(uint32_t(v));
        return indices;
    }
    Elements elements = find_elements(
        reader, primitive.where, "indices", primitive.source->indices, TINYGLTF_TYPE_SCALAR,
        {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
         TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
        "unsigned scalars");
    uint32_t restart = elements.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 0xff
                       : elements.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 0xffff
                                                                                      : 0xffffffff;
    indices.reserve(elements.count);
    for (size_t i = 0; i < elements.count; i++) {
        uint32_t index = elements.index(i);
        if (index == restart)
            reader.refuse("%s: index %zu is %u, which restarts a primitive elsewhere; glTF does "
                          "not allow it",
                          primitive.where.c_str(), i, index);
        if (index >= primitive.n_vertices)
            reader.refuse("%s: index %zu is vertex %u, but POSITION has %zu",
                          primitive.where.c_str(), i, index, primitive.n_vertices);
        indices.push_back(index);
    }
    return indices;
}

/* Three corners for each triangle, in the direction that glTF 2.0, 3.7.2.1 defines for the mode. */
std::vector<uint32_t> read_triangles(Reader &reader, const Primitive &primitive)
{
    std::vector<uint32_t> indices = read_indices(reader, primitive);
    int mode = primitive.source->mode;
    size_t n = indices.size();
    if (mode == TINYGLTF_MODE_TRIANGLES ? n % 3 != 0 : n < 3)
        reader.refuse("%s: %zu indices do not make whole triangles", primitive.where.c_str(), n);
    if (mode == TINYGLTF_MODE_TRIANGLES)
        return indices;
    std::vector<uint32_t> triangles;
    triangles.reserve(3 * (n - 2));
    for (size_t t = 0; t + 2 < n; t++) {
        bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
        size_t odd = fan ? 0 : t % 2;
        triangles.push_back(indices[fan ? t + 1 : t]);
        triangles.push_back(indices[fan ? t + 2 : t + 1 + odd]);
        triangles.push_back(indices[fan ? 0 : t + 2 - odd]);
    }
    return triangles;
}

/* True if the primitive is a surface. If not, it is counted as ignored. */
bool is_surface(Reader &reader, const Primitive &primitive)
{
    int mode = primitive.source->mode;
    if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN)
        reader.refuse("%s has mode %d, but glTF has 0 to 6", primitive.where.c_str(), mode);
    if (mode < TINYGLTF_MODE_TRIANGLES) {
        reader.passed_over.points_and_lines++;
        return false;
    }
    if (primitive.source->attributes.count("POSITION") == 0) {
        reader.passed_over.without_position++;
        return false;
    }
    return true;
}

/* The primitives of one mesh often share their POSITION. This map holds what was added already, by
 * accessor and by the morph targets applied to it. */
using Bases = std::map<std::pair<int, std::vector<Morph>>, uint32_t>;

void add_primitive(Reader &reader, Primitive &primitive, const std::vector<double> &weights,
                   const transform &matrix, Bases &bases)
{
    int accessor = primitive.source->attributes.at("POSITION");
    Elements positions = find_positions(reader, primitive.where, "POSITION", accessor);
    std::vector<Morph> morphs = find_morphs(reader, primitive, weights);
    primitive.n_vertices = positions.count;
    auto [entry, is_new] =
        bases.emplace(std::pair(accessor, morphs), uint32_t(reader.builder->cage.n_vertices));
    primitive.base = entry->second;
    if (is_new) {
        add_positions(reader, primitive, positions, morphs, matrix);
        reader.vertices_read += positions.count;
    }
    std::vector<uint32_t> indices = read_triangles(reader, primitive);
    ngon_triangles triangles;
    triangles.index = indices.data();
    triangles.n = indices.size() / 3;
    triangles.encoded = primitive.source->mode == TINYGLTF_MODE_TRIANGLES &&
                        primitive.source->extensions.count("FB_ngon_encoding") > 0;
    triangles.mirrored = transform_determinant(&matrix) < 0;
    triangles.base = primitive.base;
    reader.builder->plain_triangles |= !triangles.encoded;
    primitive.first_face = reader.builder->cage.n_faces;
    reader.need(ngon_add_faces(reader.builder, &triangles, &reader.ngon_breaks, reader.failure));
    primitive.n_faces = reader.builder->cage.n_faces - primitive.first_face;
}

} // namespace

void add_mesh(Reader &reader, int index, const std::vector<double> &weights,
              const transform &matrix)
{
    if (index < 0 || size_t(index) >= reader.model.meshes.size())
        reader.refuse("a node refers to mesh %d, but there are %zu", index,
                      reader.model.meshes.size());
    const tinygltf::Mesh &mesh = reader.model.meshes[size_t(index)];
    weld_start start = weld_begin(reader.builder);
    Bases bases;
    for (size_t i = 0; i < mesh.primitives.size(); i++) {
        Primitive primitive = {};
        primitive.source = &mesh.primitives[i];
        primitive.where = "mesh " + std::to_string(index) + " primitive " + std::to_string(i);
        if (!is_surface(reader, primitive))
            continue;
        add_primitive(reader, primitive, weights.empty() ? mesh.weights : weights, matrix, bases);
        read_tags(reader, primitive, mesh);
    }
    reader.need(cage_weld(reader.builder, &start, reader.name, reader.failure));
}

} // namespace gltf
