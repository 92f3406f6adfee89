/* What the parts of the glTF reader share. Internal to them: gltf.cpp and gltf_tags.cpp. */
#ifndef SHEEN_CAGE_READ_GLTF_READER_HPP
#define SHEEN_CAGE_READ_GLTF_READER_HPP

#include <string>

#include <tiny_gltf.h>

#include "server/cage/read/gltf.h"

namespace gltf
{

/* Thrown once *failure says why. */
struct Refused {
};

/* One primitive of one instance of a mesh, and where its parts stand in the builder. */
struct Primitive {
    const tinygltf::Primitive *source;
    std::string where; /* "mesh 2 primitive 0", for messages */
    size_t n_vertices;
    uint32_t base; /* of its first vertex */
    size_t first_face, n_faces;
};

struct Reader {
    tinygltf::Model model;
    cage_builder *builder;
    const char *name;
    error *failure;
    bool has_scheme = false, has_boundary = false, has_triangle_rule = false;
    bool skinned = false, morphed = false;
    bool warned_negative = false; /* sharpness */
    size_t ngon_breaks = 0;

    [[noreturn]] void refuse(const char *format, ...) __attribute__((format(printf, 2, 3)));
    void need(bool done) const
    {
        if (!done)
            throw Refused();
    }
};

/* Adds the creases, corners, holes and settings that the extras of a primitive and of its mesh
 * hold, under USD's names. The primitive's faces and vertices are in the builder. */
void read_tags(Reader &reader, const Primitive &primitive, const tinygltf::Mesh &mesh);

} // namespace gltf

#endif
