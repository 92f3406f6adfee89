/* Joins triangles to polygons by glTF's FB_ngon_encoding. Internal to the glTF reader. Any
 * thread. */
#ifndef SHEEN_CAGE_READ_GLTF_NGON_H
#define SHEEN_CAGE_READ_GLTF_NGON_H

#include "server/cage/build/builder.h"

#ifdef __cplusplus
extern "C" {
#endif

struct ngon_triangles {
    const uint32_t *index; /* [3 * n], the corners in the file's order */
    size_t n;
    /* FB_ngon_encoding: consecutive triangles with the same first vertex are one polygon; false:
     * every triangle is a face. */
    bool encoded;
    bool mirrored; /* reverse the faces, but keep their first corner */
    uint32_t base; /* added to every index */
};

/* Adds the faces to the builder. Triangles that share their first vertex but no edge, which the
 * extension forbids, become separate faces and are counted in *n_breaks. False with the builder's
 * errors. */
bool ngon_add_faces(struct cage_builder *builder, const struct ngon_triangles *triangles,
                    size_t *n_breaks, struct error *error);

#ifdef __cplusplus
}
#endif

#endif
