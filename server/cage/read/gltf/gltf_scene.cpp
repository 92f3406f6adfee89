#include "server/cage/read/gltf/gltf_reader.hpp"

#include <algorithm>
#include <cmath>

namespace gltf
{

namespace
{

/* Limit of mesh instances in a file: each instance is read again, however small it is. */
constexpr size_t MAX_INSTANCES = 1000000;

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

/* EXT_mesh_gpu_instancing */

/* One of the three attributes: the numbers of all elements in order, or none. */
struct Attribute {
    std::vector<double> numbers;
    size_t n_components;
    std::vector<double> standard;

    void copy(size_t instance, double *out) const
    {
        const double *from = numbers.empty() ? standard.data() : &numbers[instance * n_components];
        std::copy(from, from + n_components, out);
    }
};

/* *count is the number of elements of the attributes before, 0 if there was none. */
Attribute read_attribute(Reader &reader, const std::string &where, const tinygltf::Value &all,
                         const char *key, std::vector<double> standard, size_t *count)
{
    Attribute attribute = {{}, standard.size(), standard};
    if (!all.Has(key))
        return attribute;
    const tinygltf::Value &value = all.Get(key);
    int type = attribute.n_components == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4;
    Elements elements = find_elements(
        reader, where, key, value.IsInt() ? value.Get<int>() : -1, type,
        {TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
         TINYGLTF_COMPONENT_TYPE_SHORT},
        type == TINYGLTF_TYPE_VEC3 ? "VEC3 of floats" : "VEC4 of floats or normalized integers");
    if (*count != 0 && elements.count != *count)
        reader.refuse("%s: %s has %zu elements, another attribute has %zu", where.c_str(), key,
                      elements.count, *count);
    *count = elements.count;
    if (elements.count > MAX_INSTANCES)
        reader.refuse("%s: %s has %zu elements, at most %zu are read", where.c_str(), key,
                      elements.count, MAX_INSTANCES);
    for (size_t e = 0; e < elements.count; e++) {
        for (size_t i = 0; i < attribute.n_components; i++) {
            attribute.numbers.push_back(elements.number(e, i));
            if (!std::isfinite(attribute.numbers.back()))
                reader.refuse("%s: %s %zu is not finite", where.c_str(), key, e);
        }
    }
    return attribute;
}

/* The transforms of the node's mesh, in the node's coordinates: one, or as many as the extension
 * has. */
std::vector<transform> node_instances(Reader &reader, int index)
{
    const tinygltf::ExtensionMap &extensions = reader.model.nodes[size_t(index)].extensions;
    auto found = extensions.find("EXT_mesh_gpu_instancing");
    if (found == extensions.end())
        return {transform_identity()};
    std::string where = "node " + std::to_string(index) + ", EXT_mesh_gpu_instancing";
    if (!found->second.Has("attributes") || !found->second.Get("attributes").IsObject())
        reader.refuse("%s: it has no attributes", where.c_str());
    const tinygltf::Value &all = found->second.Get("attributes");
    size_t count = 0;
    Attribute translation = read_attribute(reader, where, all, "TRANSLATION", {0, 0, 0}, &count);
    Attribute rotation = read_attribute(reader, where, all, "ROTATION", {0, 0, 0, 1}, &count);
    Attribute scale = read_attribute(reader, where, all, "SCALE", {1, 1, 1}, &count);
    if (count == 0)
        reader.refuse("%s: none of TRANSLATION, ROTATION and SCALE says how many there are",
                      where.c_str());
    std::vector<transform> instances;
    instances.reserve(count);
    for (size_t i = 0; i < count; i++) {
        double t[3], r[4], s[3];
        translation.copy(i, t);
        rotation.copy(i, r);
        scale.copy(i, s);
        instances.push_back(transform_compose(t, r, s));
    }
    return instances;
}

/* Refuses a node whose instances would read too many vertices. Zeros of a sparse accessor take no
 * room in the file and weld to one vertex, so a cage's limits do not bound the cost of many
 * instances. `each` is what the first instance has read, `left` the number of the others. */
void limit_vertices(Reader &reader, int index, size_t each, size_t left)
{
    size_t all = reader.vertices_read + each * left;
    if (all > CAGE_MAX_VERTICES)
        reader.refuse("node %d: with its instances the scene has %zu vertices before equal ones "
                      "are joined; at most %u are read",
                      index, all, CAGE_MAX_VERTICES);
}

void add_instances(Reader &reader, int index, const transform &matrix)
{
    const tinygltf::Node &node = reader.model.nodes[size_t(index)];
    const std::vector<transform> instances = node_instances(reader, index);
    for (size_t i = 0; i < instances.size(); i++) {
        if (++reader.instances > MAX_INSTANCES)
            reader.refuse("its nodes show meshes more than %zu times", MAX_INSTANCES);
        transform world = transform_multiply(&matrix, &instances[i]);
        size_t before = reader.vertices_read;
        add_mesh(reader, node.mesh, node.weights, world);
        limit_vertices(reader, index, reader.vertices_read - before, instances.size() - 1 - i);
    }
}

/* Nodes */

struct Visit {
    int node;
    transform parent;
};

/* The nodes to start from: those of the default scene; if there is no scene, those without a
 * parent. */
std::vector<int> root_nodes(Reader &reader)
{
    const tinygltf::Model &model = reader.model;
    size_t scene = model.defaultScene < 0 ? 0 : size_t(model.defaultScene);
    if (model.defaultScene < 0 && model.scenes.size() > 1)
        cage_warn(&reader.builder->cage,
                  "%s: 1 of its %zu scenes is read, the first: it names no default", reader.name,
                  model.scenes.size());
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

bool is_hidden(const tinygltf::Node &node)
{
    auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible"))
        return false;
    const tinygltf::Value &visible = found->second.Get("visible");
    return visible.IsBool() && !visible.Get<bool>();
}

} // namespace

/* Depth first, in the file's order. glTF's nodes form trees, so a node that occurs twice means a
 * cycle or a second parent; refusing it also bounds the walk. */
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
        if (is_hidden(node)) {
            reader.passed_over.hidden_nodes++;
            continue;
        }
        transform local = node_matrix(reader, visit.node);
        transform matrix = transform_multiply(&visit.parent, &local);
        reader.passed_over.skins |= node.skin >= 0;
        if (node.mesh != -1)
            add_instances(reader, visit.node, matrix);
        push(node.children, matrix);
    }
}

} // namespace gltf
