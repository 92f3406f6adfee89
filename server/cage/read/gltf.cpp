#include "server/cage/read/gltf_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <map>
#include <vector>

#include "server/cage/read/gltf_container.h"
#include "server/cage/read/ngon.h"
#include "server/cage/read/transform.h"
#include "server/cage/read/weld.h"

namespace gltf
{

void Reader::refuse(const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    error_set(failure, ERROR_MODEL, "%s: %s", name, text);
    throw Refused();
}

namespace
{

bool starts_with(const std::string &text, const char *start)
{
    return text.compare(0, strlen(start), start) == 0;
}

/* File access and images: refused and skipped. */

bool no_file(const std::string &, void *)
{
    return false;
}

std::string same_path(const std::string &path, void *)
{
    return path;
}

bool no_reading(std::vector<unsigned char> *, std::string *, const std::string &, void *)
{
    return false;
}

bool no_writing(std::string *, const std::string &, const std::vector<unsigned char> &, void *)
{
    return false;
}

bool skip_image(tinygltf::Image *, const int, std::string *, std::string *, int, int,
                const unsigned char *, int, void *)
{
    return true;
}

/* Text that is no JSON object at all gets a plain word instead of a parser's. */
bool looks_like_json(const char *text, size_t size)
{
    size_t at = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (at < size && memchr(" \t\r\n", text[at], 4))
        at++;
    return at < size && text[at] == '{';
}

/* What the library says without the names of its parts: "[json.exception.parse_error.101] ...". */
std::string plain_problem(const std::string &problem)
{
    std::string line = problem.substr(0, problem.find('\n'));
    size_t end = starts_with(line, "[json.exception.") ? line.find("] ") : std::string::npos;
    return end == std::string::npos ? line : "its JSON is broken: " + line.substr(end + 2);
}

void parse(Reader &reader, const gltf_container &container, const void *bytes)
{
    if (!container.binary && !looks_like_json(static_cast<const char *>(bytes), container.length))
        reader.refuse("not a glTF file: it begins neither with '{' (JSON) nor with 'glTF' (GLB); "
                      "an OBJ file needs a name that ends in .obj");
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks({no_file, same_path, no_reading, no_writing, nullptr});
    loader.SetImageLoader(skip_image, nullptr);
    std::string problem, warning;
    bool done =
        container.binary
            ? loader.LoadBinaryFromMemory(&reader.model, &problem, &warning,
                                          static_cast<const unsigned char *>(bytes),
                                          container.length)
            : loader.LoadASCIIFromString(&reader.model, &problem, &warning,
                                         static_cast<const char *>(bytes), container.length, "");
    /* The library drops what it cannot parse and goes on; a part of the cage may be missing. */
    if (done && problem.empty())
        return;
    static const std::string absent = "File not found : ";
    problem = plain_problem(problem);
    if (problem.compare(0, absent.size(), absent) == 0)
        reader.refuse("it refers to the file '%.100s', but nothing outside the given file is read: "
                      "export as GLB or with embedded buffers",
                      problem.c_str() + absent.size());
    reader.refuse("not a glTF file that can be read: %.200s", problem.c_str());
}

/* An extension that the file requires changes how it is read. Those about looks do not matter. */
void check_required_extensions(Reader &reader)
{
    for (const std::string &extension : reader.model.extensionsRequired)
        if (extension != "FB_ngon_encoding" && !starts_with(extension, "KHR_materials_") &&
            !starts_with(extension, "KHR_texture_") && !starts_with(extension, "EXT_texture_") &&
            !starts_with(extension, "KHR_lights_"))
            reader.refuse("it requires the extension '%.60s', which is not read",
                          extension.c_str());
}

/* Accessors */

struct View {
    const unsigned char *data;
    size_t stride, count;
    int component;
};

size_t component_bytes(int component)
{
    switch (component) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    default: /* unsigned int and float, the only others that are read */
        return 4;
    }
}

const tinygltf::Accessor &find_accessor(Reader &reader, const std::string &where, const char *what,
                                        int index)
{
    if (index < 0 || size_t(index) >= reader.model.accessors.size())
        reader.refuse("%s: %s refers to accessor %d, but there are %zu", where.c_str(), what, index,
                      reader.model.accessors.size());
    return reader.model.accessors[size_t(index)];
}

/* The bytes behind an accessor of `n_components`, after every bound has been checked. */
View view_accessor(Reader &reader, const std::string &where, const char *what,
                   const tinygltf::Accessor &accessor, size_t n_components)
{
    const tinygltf::Model &model = reader.model;
    const char *place = where.c_str();
    if (accessor.sparse.isSparse)
        reader.refuse("%s: %s is a sparse accessor, which is not read", place, what);
    if (accessor.bufferView < 0 || size_t(accessor.bufferView) >= model.bufferViews.size())
        reader.refuse("%s: %s has buffer view %d, but there are %zu", place, what,
                      accessor.bufferView, model.bufferViews.size());
    const tinygltf::BufferView &view = model.bufferViews[size_t(accessor.bufferView)];
    if (view.buffer < 0 || size_t(view.buffer) >= model.buffers.size())
        reader.refuse("%s: %s has buffer %d, but there are %zu", place, what, view.buffer,
                      model.buffers.size());
    const std::vector<unsigned char> &data = model.buffers[size_t(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        reader.refuse("%s: the buffer view of %s ends beyond its buffer of %zu bytes", place, what,
                      data.size());
    size_t element = component_bytes(accessor.componentType) * n_components;
    size_t stride = view.byteStride ? view.byteStride : element, span = 0, end = 0;
    if (stride < element)
        reader.refuse("%s: the stride of %s is %zu bytes, an element has %zu", place, what, stride,
                      element);
    if (accessor.count == 0)
        reader.refuse("%s: %s has no element", place, what);
    if (__builtin_mul_overflow(accessor.count - 1, stride, &span) ||
        __builtin_add_overflow(span, element, &span) ||
        __builtin_add_overflow(span, accessor.byteOffset, &end) || end > view.byteLength)
        reader.refuse("%s: %s has %zu elements, more than its buffer view of %zu bytes holds",
                      place, what, accessor.count, view.byteLength);
    return {data.data() + view.byteOffset + accessor.byteOffset, stride, accessor.count,
            accessor.componentType};
}

int position_accessor(Reader &reader, const Primitive &primitive)
{
    auto found = primitive.source->attributes.find("POSITION");
    if (found == primitive.source->attributes.end())
        reader.refuse("%s has no POSITION", primitive.where.c_str());
    return found->second;
}

View view_positions(Reader &reader, const Primitive &primitive)
{
    const tinygltf::Accessor &accessor =
        find_accessor(reader, primitive.where, "POSITION", position_accessor(reader, primitive));
    if (accessor.type != TINYGLTF_TYPE_VEC3 ||
        accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
        reader.refuse("%s: POSITION must be three floats (VEC3, 5126), not quantized",
                      primitive.where.c_str());
    return view_accessor(reader, primitive.where, "POSITION", accessor, 3);
}

void add_positions(Reader &reader, const Primitive &primitive, const View &view,
                   const transform &matrix)
{
    for (size_t v = 0; v < view.count; v++) {
        float local[3];
        double world[3];
        memcpy(local, view.data + v * view.stride, sizeof local);
        if (!std::isfinite(local[0]) || !std::isfinite(local[1]) || !std::isfinite(local[2]))
            reader.refuse("%s: POSITION %zu is not finite", primitive.where.c_str(), v);
        transform_point(&matrix, local, world);
        reader.need(cage_builder_vertex(reader.builder, world, reader.failure));
    }
}

uint32_t read_index(const View &view, size_t i)
{
    uint32_t index = 0; /* little-endian, as all of glTF */
    for (size_t b = 0; b < component_bytes(view.component); b++)
        index |= uint32_t(view.data[i * view.stride + b]) << (8 * b);
    return index;
}

std::vector<uint32_t> read_triangles(Reader &reader, const Primitive &primitive)
{
    const char *place = primitive.where.c_str();
    std::vector<uint32_t> triangles;
    int accessor = primitive.source->indices;
    if (accessor == -1) {
        for (size_t v = 0; v < primitive.n_vertices; v++)
            triangles.push_back(uint32_t(v));
    } else {
        const tinygltf::Accessor &source =
            find_accessor(reader, primitive.where, "indices", accessor);
        int component = source.componentType;
        if (source.type != TINYGLTF_TYPE_SCALAR ||
            (component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
             component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
             component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
            reader.refuse("%s: indices must be unsigned scalars", place);
        View view = view_accessor(reader, primitive.where, "indices", source, 1);
        triangles.reserve(view.count);
        for (size_t i = 0; i < view.count; i++) {
            triangles.push_back(read_index(view, i));
            if (triangles.back() >= primitive.n_vertices)
                reader.refuse("%s: index %zu is vertex %u, but POSITION has %zu", place, i,
                              triangles.back(), primitive.n_vertices);
        }
    }
    if (triangles.size() % 3 != 0)
        reader.refuse("%s: %zu indices do not make whole triangles", place, triangles.size());
    return triangles;
}

/* Meshes and nodes */

void check_primitive(Reader &reader, const Primitive &primitive)
{
    static const char *const modes[] = {"POINTS",    "LINES",          "LINE_LOOP",   "LINE_STRIP",
                                        "TRIANGLES", "TRIANGLE_STRIP", "TRIANGLE_FAN"};
    int mode = primitive.source->mode;
    if (mode != TINYGLTF_MODE_TRIANGLES)
        reader.refuse("%s has mode %d (%s), only 4 (TRIANGLES) makes a cage",
                      primitive.where.c_str(), mode, mode >= 0 && mode < 7 ? modes[mode] : "none");
    for (const char *extension : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
        if (primitive.source->extensions.count(extension))
            reader.refuse("%s uses %s, which is not read", primitive.where.c_str(), extension);
    reader.morphed |= !primitive.source->targets.empty();
}

/* The primitives of one mesh often share their POSITION: `bases` holds what was added. */
void add_primitive(Reader &reader, Primitive &primitive, const transform &matrix, bool mirrored,
                   std::map<int, uint32_t> &bases)
{
    check_primitive(reader, primitive);
    View positions = view_positions(reader, primitive);
    primitive.n_vertices = positions.count;
    auto [entry, is_new] = bases.emplace(position_accessor(reader, primitive),
                                         uint32_t(reader.builder->cage.n_vertices));
    primitive.base = entry->second;
    if (is_new)
        add_positions(reader, primitive, positions, matrix);

    std::vector<uint32_t> indices = read_triangles(reader, primitive);
    ngon_triangles triangles;
    triangles.index = indices.data();
    triangles.n = indices.size() / 3;
    triangles.encoded = primitive.source->extensions.count("FB_ngon_encoding") > 0;
    triangles.mirrored = mirrored;
    triangles.base = primitive.base;
    reader.builder->plain_triangles |= !triangles.encoded;
    primitive.first_face = reader.builder->cage.n_faces;
    reader.need(ngon_add_faces(reader.builder, &triangles, &reader.ngon_breaks, reader.failure));
    primitive.n_faces = reader.builder->cage.n_faces - primitive.first_face;
}

void add_mesh(Reader &reader, int index, const transform &matrix)
{
    if (index < 0 || size_t(index) >= reader.model.meshes.size())
        reader.refuse("a node refers to mesh %d, but there are %zu", index,
                      reader.model.meshes.size());
    const tinygltf::Mesh &mesh = reader.model.meshes[size_t(index)];
    std::map<int, uint32_t> bases;
    for (size_t i = 0; i < mesh.primitives.size(); i++) {
        Primitive primitive = {};
        primitive.source = &mesh.primitives[i];
        primitive.where = "mesh " + std::to_string(index) + " primitive " + std::to_string(i);
        add_primitive(reader, primitive, matrix, transform_determinant(&matrix) < 0, bases);
        read_tags(reader, primitive, mesh);
    }
}

std::vector<double> node_numbers(Reader &reader, int index, const char *key,
                                 const std::vector<double> &given,
                                 const std::vector<double> &standard)
{
    if (given.empty())
        return standard;
    bool good = given.size() == standard.size();
    for (double value : given)
        good = good && std::isfinite(value);
    if (!good)
        reader.refuse("node %d: %s needs %zu finite numbers", index, key, standard.size());
    return given;
}

transform node_matrix(Reader &reader, int index)
{
    const tinygltf::Node &node = reader.model.nodes[size_t(index)];
    transform matrix = transform_identity();
    if (!node.matrix.empty()) {
        std::vector<double> m =
            node_numbers(reader, index, "matrix", node.matrix, std::vector<double>(16));
        if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
            reader.refuse("node %d: the last row of matrix must be 0 0 0 1", index);
        std::copy(m.begin(), m.end(), matrix.m);
        return matrix;
    }
    return transform_compose(
        node_numbers(reader, index, "translation", node.translation, {0, 0, 0}).data(),
        node_numbers(reader, index, "rotation", node.rotation, {0, 0, 0, 1}).data(),
        node_numbers(reader, index, "scale", node.scale, {1, 1, 1}).data());
}

struct Visit {
    int node;
    transform parent;
};

/* The nodes to start from: those of the default scene, or, where there is no scene, those that are
 * nobody's child. */
std::vector<int> root_nodes(Reader &reader)
{
    const tinygltf::Model &model = reader.model;
    size_t scene = model.defaultScene < 0 ? 0 : size_t(model.defaultScene);
    if (scene < model.scenes.size())
        return model.scenes[scene].nodes;
    if (!model.scenes.empty() || model.defaultScene >= 0)
        reader.refuse("the default scene is %zu, but there are %zu", scene, model.scenes.size());
    std::vector<bool> is_child(model.nodes.size());
    for (const tinygltf::Node &node : model.nodes)
        for (int child : node.children)
            if (child >= 0 && size_t(child) < is_child.size())
                is_child[size_t(child)] = true;
    std::vector<int> roots;
    for (size_t n = 0; n < is_child.size(); n++)
        if (!is_child[n])
            roots.push_back(int(n));
    return roots;
}

/* Depth first in the order of the file. glTF's nodes form trees, so one that comes up twice means
 * a cycle or a second parent; refusing it also bounds the walk. */
void add_scene(Reader &reader)
{
    std::vector<bool> seen(reader.model.nodes.size());
    std::vector<Visit> stack;
    auto push = [&](const std::vector<int> &nodes, const transform &parent) {
        for (size_t i = nodes.size(); i-- > 0;)
            stack.push_back({nodes[i], parent});
    };
    push(root_nodes(reader), transform_identity());
    while (!stack.empty()) {
        Visit visit = stack.back();
        stack.pop_back();
        if (visit.node < 0 || size_t(visit.node) >= seen.size())
            reader.refuse("the scene refers to node %d, but there are %zu", visit.node,
                          seen.size());
        if (seen[size_t(visit.node)])
            reader.refuse("node %d is reached twice: a cycle, or two parents", visit.node);
        seen[size_t(visit.node)] = true;
        const tinygltf::Node &node = reader.model.nodes[size_t(visit.node)];
        transform local = node_matrix(reader, visit.node);
        transform matrix = transform_multiply(&visit.parent, &local);
        reader.skinned |= node.skin >= 0;
        if (node.mesh != -1)
            add_mesh(reader, node.mesh, matrix);
        push(node.children, matrix);
    }
}

void add_warnings(Reader &reader)
{
    cage *target = &reader.builder->cage;
    if (reader.ngon_breaks > 0)
        cage_warn(target,
                  "%s: FB_ngon_encoding is broken, triangles that do not continue their polygon: "
                  "%zu; a tool may have reordered them",
                  reader.name, reader.ngon_breaks);
    if (reader.skinned)
        cage_warn(target, "%s: skins are passed over: the cage stands in its bind pose",
                  reader.name);
    if (reader.morphed)
        cage_warn(target, "%s: morph targets are passed over", reader.name);
}

void read(Reader &reader, const void *bytes, size_t size)
{
    gltf_container container;
    reader.need(gltf_container_check(&container, bytes, size, reader.name, reader.failure));
    parse(reader, container, bytes);
    check_required_extensions(reader);
    add_scene(reader);
    reader.model = {}; /* the buffers are not needed any more, and welding takes memory */
    add_warnings(reader);
    reader.need(cage_weld(reader.builder, reader.name, reader.failure));
}

} // namespace

} // namespace gltf

extern "C" bool gltf_read(cage_builder *builder, const void *bytes, size_t size, const char *name,
                          error *error)
{
    try {
        gltf::Reader reader = {};
        reader.builder = builder;
        builder->cage.up = CAGE_UP_Y; /* says the specification */
        reader.name = name;
        reader.failure = error;
        gltf::read(reader, bytes, size);
        return true;
    } catch (const gltf::Refused &) {
        return false;
    } catch (const std::bad_alloc &) {
        return error_set(error, ERROR_SERVER, "%s: not enough memory to read it", name);
    } catch (const std::exception &problem) {
        return error_set(error, ERROR_MODEL, "%s: not a glTF file that can be read: %.200s", name,
                         problem.what());
    } catch (...) {
        return error_set(error, ERROR_MODEL, "%s: not a glTF file that can be read", name);
    }
}
