/* Joins vertices at equal positions: glTF files split vertices where normals or texture
 * coordinates differ, and OBJ files may ask for welding. Internal to server/cage; any thread. */
#ifndef SHEEN_CAGE_BUILD_WELD_H
#define SHEEN_CAGE_BUILD_WELD_H

#include "server/cage/build/builder.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The lengths of the builder's arrays at the start of the part to weld. What is before that
 * stays as it is. Zeros: the whole cage is welded. */
struct weld_start {
    size_t vertices, face_vertices, creases, corners;
};

/* The start of a part that is about to be read: the arrays' present lengths. */
struct weld_start weld_begin(const struct cage_builder *builder);

/* Makes one vertex of all vertices from `start` on whose coordinates are equal (-0.0 equals 0.0),
 * and renumbers the faces, creases and corner tags from `start` on. The vertices that stay keep the
 * order in which each place first came. Linear in the number of vertices. No face or tag is
 * dropped, even where two corners of a face have become one vertex: cage_repair() does that, and
 * warns. Faces from `start` on must name vertices from `start` on, in range; tags may name any.
 *
 * `name` is the file's, for texts. False: ERROR_SERVER, memory is short; the builder is as it was.
 */
bool cage_weld(struct cage_builder *builder, const struct weld_start *start, const char *name,
               struct error *error);

#ifdef __cplusplus
}
#endif

#endif
