#include "server/cage/read/gltf/gltf_reader.hpp"

#include <cmath>
#include <vector>

using tinygltf::Value;

namespace gltf
{

namespace
{

/* The object with the tags: extras.subdiv, or extras itself. */
const Value *tags_of(const Value &extras)
{
    if (!extras.IsObject())
        return nullptr;
    if (extras.Has("subdiv") && extras.Get("subdiv").IsObject())
        return &extras.Get("subdiv");
    return &extras;
}

const Value::Array &tag_array(Reader &reader, const Primitive &primitive, const Value &tags,
                              const char *key)
{
    static const Value::Array none;
    if (!tags.Has(key))
        return none;
    if (!tags.Get(key).IsArray())
        reader.refuse("%s: %s is not an array", primitive.where.c_str(), key);
    return tags.Get(key).Get<Value::Array>();
}

size_t tag_index(Reader &reader, const Primitive &primitive, const Value::Array &array, size_t i,
                 const char *key, size_t limit, const char *what)
{
    double value = array[i].IsNumber() ? array[i].GetNumberAsDouble() : -1;
    if (!(value >= 0) || value != std::floor(value))
        reader.refuse("%s: %s[%zu] is not an index", primitive.where.c_str(), key, i);
    if (value >= double(limit))
        reader.refuse("%s: %s[%zu] is %.0f, but the primitive has %zu %s", primitive.where.c_str(),
                      key, i, value, limit, what);
    return size_t(value);
}

float tag_sharpness(Reader &reader, const Primitive &primitive, const Value::Array &array, size_t i,
                    const char *key)
{
    double value = array[i].IsNumber() ? array[i].GetNumberAsDouble() : NAN;
    if (!std::isfinite(float(value)))
        reader.refuse("%s: %s[%zu] is not a finite number", primitive.where.c_str(), key, i);
    if (value < 0 && !reader.warned_negative) {
        reader.warned_negative = true;
        cage_warn(&reader.builder->cage,
                  "%s: %s: %s[%zu] is %g and counts as 0, as any other below 0", reader.name,
                  primitive.where.c_str(), key, i, value);
    }
    return value > 0 ? float(value) : 0;
}

/* The number of edges of each crease, from creaseLengths (vertices of each). */
std::vector<size_t> crease_edges(Reader &reader, const Primitive &primitive, const Value &tags,
                                 size_t n_indices)
{
    const Value::Array &lengths = tag_array(reader, primitive, tags, "creaseLengths");
    std::vector<size_t> edges;
    size_t sum = 0;
    for (size_t i = 0; i < lengths.size(); i++) {
        size_t length = tag_index(reader, primitive, lengths, i, "creaseLengths", n_indices + 1,
                                  "crease indices");
        if (length < 2)
            reader.refuse("%s: creaseLengths[%zu] is %zu, a crease has at least 2 vertices",
                          primitive.where.c_str(), i, length);
        sum += length;
        edges.push_back(length - 1);
    }
    if (sum != n_indices)
        reader.refuse("%s: creaseLengths add up to %zu, but creaseIndices has %zu",
                      primitive.where.c_str(), sum, n_indices);
    return edges;
}

void read_creases(Reader &reader, const Primitive &primitive, const Value &tags)
{
    const Value::Array &indices = tag_array(reader, primitive, tags, "creaseIndices");
    const Value::Array &sharpnesses = tag_array(reader, primitive, tags, "creaseSharpnesses");
    std::vector<size_t> edges = crease_edges(reader, primitive, tags, indices.size());
    size_t n_edges = indices.size() - edges.size();
    if (sharpnesses.size() != edges.size() && sharpnesses.size() != n_edges)
        reader.refuse("%s: %zu creaseSharpnesses for %zu creases of %zu edges: give one for each "
                      "crease or one for each edge",
                      primitive.where.c_str(), sharpnesses.size(), edges.size(), n_edges);
    bool each_edge = sharpnesses.size() != edges.size();
    size_t at = 0, edge = 0;
    for (size_t i = 0; i < edges.size(); i++, at++) {
        for (size_t e = 0; e < edges[i]; e++, at++, edge++) {
            cage_crease crease;
            for (size_t end = 0; end < 2; end++)
                crease.vertex[end] =
                    primitive.base +
                    uint32_t(tag_index(reader, primitive, indices, at + end, "creaseIndices",
                                       primitive.n_vertices, "vertices"));
            crease.sharpness = tag_sharpness(reader, primitive, sharpnesses, each_edge ? edge : i,
                                             "creaseSharpnesses");
            reader.need(cage_builder_crease(reader.builder, &crease, 0, reader.failure));
        }
    }
}

void read_corners_and_holes(Reader &reader, const Primitive &primitive, const Value &tags)
{
    const Value::Array &corners = tag_array(reader, primitive, tags, "cornerIndices");
    const Value::Array &sharpnesses = tag_array(reader, primitive, tags, "cornerSharpnesses");
    if (corners.size() != sharpnesses.size())
        reader.refuse("%s: %zu cornerSharpnesses for %zu cornerIndices", primitive.where.c_str(),
                      sharpnesses.size(), corners.size());
    for (size_t i = 0; i < corners.size(); i++) {
        cage_corner corner;
        corner.vertex =
            primitive.base + uint32_t(tag_index(reader, primitive, corners, i, "cornerIndices",
                                                primitive.n_vertices, "vertices"));
        corner.sharpness = tag_sharpness(reader, primitive, sharpnesses, i, "cornerSharpnesses");
        reader.need(cage_builder_corner(reader.builder, &corner, 0, reader.failure));
    }
    const Value::Array &holes = tag_array(reader, primitive, tags, "holeIndices");
    for (size_t i = 0; i < holes.size(); i++) {
        size_t face = primitive.first_face + tag_index(reader, primitive, holes, i, "holeIndices",
                                                       primitive.n_faces, "faces");
        reader.need(cage_builder_hole(reader.builder, uint32_t(face), 0, reader.failure));
    }
}

/* Reads a setting whose value is one of a few words. Returns whether it is present; *choice is its
 * index in words[]. */
bool read_word(Reader &reader, const Primitive &primitive, const Value &tags, const char *key,
               const std::vector<const char *> &words, size_t *choice)
{
    if (!tags.Has(key))
        return false;
    const Value &value = tags.Get(key);
    std::string word = value.IsString() ? value.Get<std::string>() : "";
    for (*choice = 0; *choice < words.size(); ++*choice)
        if (word == words[*choice])
            return true;
    std::string all;
    for (const char *known : words)
        all += all.empty() ? known : std::string(", ") + known;
    reader.refuse("%s: %s is '%.40s', needs one of %s", primitive.where.c_str(), key, word.c_str(),
                  all.c_str());
}

template <typename T>
void settle(Reader &reader, const Primitive &primitive, const char *key, bool *said, T *setting,
            T value)
{
    if (*said && *setting != value)
        reader.refuse("%s: %s differs from another primitive's, but a cage has only one",
                      primitive.where.c_str(), key);
    *said = true;
    *setting = value;
}

void read_settings(Reader &reader, const Primitive &primitive, const Value &tags)
{
    cage &target = reader.builder->cage;
    size_t choice;
    if (read_word(reader, primitive, tags, "interpolateBoundary",
                  {"edgeOnly", "edgeAndCorner", "none"}, &choice)) {
        static const cage_boundary modes[] = {CAGE_BOUNDARY_EDGE_ONLY,
                                              CAGE_BOUNDARY_EDGE_AND_CORNER, CAGE_BOUNDARY_NONE};
        settle(reader, primitive, "interpolateBoundary", &reader.has_boundary, &target.boundary,
               modes[choice]);
    }
    if (read_word(reader, primitive, tags, "subdivisionScheme",
                  {"catmullClark", "loop", "bilinear"}, &choice)) {
        static const cage_scheme schemes[] = {CAGE_SCHEME_CATMULL_CLARK, CAGE_SCHEME_LOOP,
                                              CAGE_SCHEME_BILINEAR};
        settle(reader, primitive, "subdivisionScheme", &reader.has_scheme, &target.scheme,
               schemes[choice]);
    }
    if (read_word(reader, primitive, tags, "triangleSubdivisionRule", {"catmullClark", "smooth"},
                  &choice))
        settle(reader, primitive, "triangleSubdivisionRule", &reader.has_triangle_rule,
               &target.smooth_triangles, choice == 1);
}

} // namespace

/* Index arrays in a mesh's extras refer to its only primitive; with several primitives they would
 * be ambiguous. */
void read_tags(Reader &reader, const Primitive &primitive, const tinygltf::Mesh &mesh)
{
    const Value *tags = tags_of(mesh.extras);
    if (tags) {
        read_settings(reader, primitive, *tags);
        if (mesh.primitives.size() == 1) {
            read_creases(reader, primitive, *tags);
            read_corners_and_holes(reader, primitive, *tags);
        } else if (tags->Has("creaseIndices") || tags->Has("cornerIndices") ||
                   tags->Has("holeIndices")) {
            reader.refuse("%s: the mesh's extras hold crease, corner or hole indices, but it has "
                          "%zu primitives: put them into each primitive's extras",
                          primitive.where.c_str(), mesh.primitives.size());
        }
    }
    tags = tags_of(primitive.source->extras);
    if (tags) {
        read_settings(reader, primitive, *tags);
        read_creases(reader, primitive, *tags);
        read_corners_and_holes(reader, primitive, *tags);
    }
}

} // namespace gltf
