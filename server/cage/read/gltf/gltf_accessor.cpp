#include "server/cage/read/gltf/gltf_reader.hpp"

#include <algorithm>
#include <cstring>

#include "server/cage/read/gltf/gltf_extensions.h"

namespace gltf
{

namespace
{

size_t component_bytes(int component)
{
    switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    default: /* unsigned int and float: no other types are read */
        return 4;
    }
}

bool is_index(int component)
{
    return component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

uint32_t read_unsigned(const unsigned char *at, size_t bytes)
{
    uint32_t value = 0; /* little-endian, as all of glTF */
    for (size_t b = 0; b < bytes; b++)
        value |= uint32_t(at[b]) << (8 * b);
    return value;
}

/* A run of elements inside a buffer view. */
struct Span {
    const unsigned char *data;
    size_t stride;
};

const std::vector<unsigned char> &buffer_of(Reader &reader, const char *place, const char *what,
                                            const tinygltf::BufferView &view)
{
    const std::vector<tinygltf::Buffer> &buffers = reader.model.buffers;
    if (view.buffer < 0 || size_t(view.buffer) >= buffers.size())
        reader.refuse("%s: %s has buffer %d, but there are %zu", place, what, view.buffer,
                      buffers.size());
    /* The library uses the binary chunk for every buffer without a URI, but it belongs only to the
     * first buffer. */
    if (reader.binary && view.buffer > 0 && buffers[size_t(view.buffer)].uri.empty()) {
        if (reader.packing)
            reader.need(gltf_extension_refuse_packing(reader.packing, reader.name, reader.failure));
        reader.refuse("%s: %s has buffer %d, which holds no data", place, what, view.buffer);
    }
    return buffers[size_t(view.buffer)].data;
}

Span find_span(Reader &reader, const std::string &where, const char *what, int view_index,
               size_t offset, size_t count, size_t element, bool may_stride)
{
    const tinygltf::Model &model = reader.model;
    const char *place = where.c_str();
    if (view_index < 0 || size_t(view_index) >= model.bufferViews.size())
        reader.refuse("%s: %s has buffer view %d, but there are %zu", place, what, view_index,
                      model.bufferViews.size());
    const tinygltf::BufferView &view = model.bufferViews[size_t(view_index)];
    const std::vector<unsigned char> &data = buffer_of(reader, place, what, view);
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        reader.refuse("%s: the buffer view of %s ends beyond its buffer of %zu bytes", place, what,
                      data.size());
    size_t stride = may_stride && view.byteStride ? view.byteStride : element, span = 0, end = 0;
    if (stride < element)
        reader.refuse("%s: the stride of %s is %zu bytes, an element has %zu", place, what, stride,
                      element);
    if (count == 0)
        reader.refuse("%s: %s has no element", place, what);
    if (__builtin_mul_overflow(count - 1, stride, &span) ||
        __builtin_add_overflow(span, element, &span) ||
        __builtin_add_overflow(span, offset, &end) || end > view.byteLength)
        reader.refuse("%s: %s has %zu elements, more than its buffer view of %zu bytes holds",
                      place, what, count, view.byteLength);
    return {data.data() + view.byteOffset + offset, stride};
}

/* The indices of the elements that a sparse accessor replaces. */
std::vector<uint32_t> sparse_indices(Reader &reader, const std::string &where, const char *what,
                                     const tinygltf::Accessor &accessor)
{
    const auto &indices = accessor.sparse.indices;
    std::string of = std::string("sparse.indices of ") + what;
    if (accessor.sparse.count < 1 || size_t(accessor.sparse.count) > accessor.count)
        reader.refuse("%s: %s replaces %d of its %zu elements", where.c_str(), what,
                      accessor.sparse.count, accessor.count);
    if (!is_index(indices.componentType))
        reader.refuse("%s: %s must be unsigned integers", where.c_str(), of.c_str());
    size_t bytes = component_bytes(indices.componentType), count = size_t(accessor.sparse.count);
    Span span = find_span(reader, where, of.c_str(), indices.bufferView, size_t(indices.byteOffset),
                          count, bytes, false);
    std::vector<uint32_t> list(count);
    for (size_t i = 0; i < count; i++) {
        list[i] = read_unsigned(span.data + i * span.stride, bytes);
        if (list[i] >= accessor.count)
            reader.refuse("%s: %s[%zu] is %u, but there are %zu elements", where.c_str(),
                          of.c_str(), i, list[i], accessor.count);
        if (i > 0 && list[i] <= list[i - 1])
            reader.refuse("%s: %s[%zu] does not ascend", where.c_str(), of.c_str(), i);
    }
    return list;
}

} // namespace

const unsigned char *Elements::at(size_t element) const
{
    auto found = std::lower_bound(sparse_index.begin(), sparse_index.end(), element);
    if (found != sparse_index.end() && *found == element)
        return sparse_data + size_t(found - sparse_index.begin()) * size;
    return data ? data + element * stride : nullptr;
}

uint32_t Elements::index(size_t element) const
{
    const unsigned char *bytes = at(element);
    return bytes ? read_unsigned(bytes, component_bytes(component)) : 0;
}

double Elements::number(size_t element, size_t i) const
{
    const unsigned char *bytes = at(element);
    if (!bytes)
        return 0;
    size_t n = component_bytes(component);
    uint32_t bits = read_unsigned(bytes + i * n, n);
    switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return normalized ? std::max(int8_t(bits) / 127.0, -1.0) : int8_t(bits);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return normalized ? bits / 255.0 : bits;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return normalized ? std::max(int16_t(bits) / 32767.0, -1.0) : int16_t(bits);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return normalized ? bits / 65535.0 : bits;
    case TINYGLTF_COMPONENT_TYPE_FLOAT: {
        float value;
        memcpy(&value, &bits, sizeof value);
        return double(value);
    }
    default:
        return bits;
    }
}

Elements find_elements(Reader &reader, const std::string &where, const char *what, int index,
                       int type, std::initializer_list<int> components, const char *needed)
{
    const tinygltf::Model &model = reader.model;
    if (index < 0 || size_t(index) >= model.accessors.size())
        reader.refuse("%s: %s refers to accessor %d, but there are %zu", where.c_str(), what, index,
                      model.accessors.size());
    const tinygltf::Accessor &accessor = model.accessors[size_t(index)];
    if (accessor.type != type ||
        std::find(components.begin(), components.end(), accessor.componentType) == components.end())
        reader.refuse("%s: %s must be %s", where.c_str(), what, needed);
    Elements elements;
    elements.count = accessor.count;
    elements.component = accessor.componentType;
    elements.normalized = accessor.normalized;
    elements.size = component_bytes(accessor.componentType) *
                    size_t(tinygltf::GetNumComponentsInType(uint32_t(type)));
    if (accessor.bufferView != -1) {
        Span span = find_span(reader, where, what, accessor.bufferView, accessor.byteOffset,
                              accessor.count, elements.size, true);
        elements.data = span.data;
        elements.stride = span.stride;
    } else if (!accessor.sparse.isSparse) {
        if (reader.packing)
            reader.need(gltf_extension_refuse_packing(reader.packing, reader.name, reader.failure));
        reader.refuse("%s: %s has no buffer view, so it holds no data", where.c_str(), what);
    } else if (accessor.count > reader.file_bytes) {
        /* Such elements are zeros and take no room in the file, so the file's size would not limit
         * the memory. */
        reader.refuse("%s: %s has %zu elements without a buffer view, more than the file has bytes",
                      where.c_str(), what, accessor.count);
    }
    if (accessor.sparse.isSparse) {
        elements.sparse_index = sparse_indices(reader, where, what, accessor);
        elements.sparse_data =
            find_span(reader, where, (std::string("sparse.values of ") + what).c_str(),
                      accessor.sparse.values.bufferView, size_t(accessor.sparse.values.byteOffset),
                      elements.sparse_index.size(), elements.size, false)
                .data;
    }
    return elements;
}

} // namespace gltf
