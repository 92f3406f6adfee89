/* Joins vertices at equal positions. glTF files split vertices where normals or texture coordinates
 * differ; OBJ files may ask for welding. Internal to server/cage. Any thread. */
#ifndef SHEEN_CAGE_BUILD_WELD_H
#define SHEEN_CAGE_BUILD_WELD_H

#include "server/cage/build/builder.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The lengths of the builder's arrays where the part to weld starts; what precedes it is unchanged.
 * Zeros: the whole cage is welded. */
struct weld_start {
    size_t vertices, face_vertices, creases, corners;
};

/* The start of a part that will be read next: the current lengths of the arrays. */
struct weld_start weld_begin(const struct cage_builder *builder);

/* Joins all vertices from `start` on whose coordinates are equal (-0.0 equals 0.0), and renumbers
 * the faces, creases and corner tags from `start` on. The remaining vertices are in the order of
 * the first vertex at each position. Linear in the number of vertices. No face or tag is dropped,
 * even if two corners of a face have become one vertex: cage_repair() does that, and warns. Faces
 * from `start` on must have vertices from `start` on, in range; tags may have any.
 *
 * `name` is the file's, for messages. False with ERROR_SERVER when memory is short; the builder is
 * then unchanged. */
bool cage_weld(struct cage_builder *builder, const struct weld_start *start, const char *name,
               struct error *error);

#ifdef __cplusplus
}
#endif

#endif
