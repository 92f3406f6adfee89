/* What the parts of the glTF reader share. Internal to them: gltf.cpp and gltf_*.cpp. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_READER_HPP
#define SHEEN_CAGE_READ_GLTF_GLTF_READER_HPP

#include <string>
#include <vector>

#include <tiny_gltf.h>

extern "C" {
#include "server/cage/build/builder.h"
}
#include "server/cage/build/weld.h"
#include "server/cage/read/gltf/gltf_container.h"
#include "server/cage/read/numbers/transform.h"

namespace gltf
{

/* Thrown after *failure was set. */
struct Refused {
};

/* One primitive of one instance of a mesh, and where its parts begin in the builder. */
struct Primitive {
    const tinygltf::Primitive *source;
    std::string where; /* "mesh 2 primitive 0", for messages */
    size_t n_vertices;
    uint32_t base; /* index of its first vertex in the builder */
    size_t first_face, n_faces;
};

/* Counts of ignored parts of the file, by reason: one warning each. */
struct PassedOver {
    size_t points_and_lines = 0, without_position = 0, hidden_nodes = 0;
    bool skins = false, morph_rest = false, morph_weights = false;
};

struct Reader {
    tinygltf::Model model;
    cage_builder *builder;
    const char *name;
    error *failure;
    size_t file_bytes;
    bool binary;              /* GLB */
    const char *packing;      /* see struct gltf_json */
    size_t instances = 0;     /* instances of meshes so far */
    size_t vertices_read = 0; /* vertices of all instances so far, before welding */
    bool has_scheme = false, has_boundary = false, has_triangle_rule = false;
    bool warned_negative = false; /* warned of negative sharpness */
    size_t ngon_breaks = 0;
    PassedOver passed_over;

    [[noreturn]] void refuse(const char *format, ...) __attribute__((format(printf, 2, 3)));
    void need(bool done) const
    {
        if (!done)
            throw Refused();
    }
};

/* The elements of an accessor, with all bounds checked. They lie in the model's buffers. */
class Elements
{
  public:
    size_t count = 0;
    int component = 0; /* TINYGLTF_COMPONENT_TYPE_ */

    /* A component as a number; for a normalized integer from -1 to 1 or from 0 to 1. */
    double number(size_t element, size_t i) const;
    /* The one component of an unsigned integer. */
    uint32_t index(size_t element) const;

  private:
    friend Elements find_elements(Reader &, const std::string &, const char *, int, int,
                                  std::initializer_list<int>, const char *);
    const unsigned char *data = nullptr; /* null: zeros */
    size_t stride = 0, size = 0;         /* distance and size of elements in bytes */
    bool normalized = false;
    std::vector<uint32_t> sparse_index; /* ascending */
    const unsigned char *sparse_data = nullptr;

    const unsigned char *at(size_t element) const;
};

/* Finds the elements of accessor `index`, which must have `type` and one of the `components`;
 * `needed` describes them in the message, `where` and `what` say whose accessor it is. */
Elements find_elements(Reader &reader, const std::string &where, const char *what, int index,
                       int type, std::initializer_list<int> components, const char *needed);

/* Adds a mesh as a separate surface. `weights` are the node's, or empty. */
void add_mesh(Reader &reader, int index, const std::vector<double> &weights,
              const transform &matrix);

/* Adds the meshes of all nodes of the default scene. */
void add_scene(Reader &reader);

/* Adds the creases, corners, holes and settings in the extras of a primitive and of its mesh, with
 * USD's names. The primitive's faces and vertices are already in the builder. */
void read_tags(Reader &reader, const Primitive &primitive, const tinygltf::Mesh &mesh);

} // namespace gltf

#endif
