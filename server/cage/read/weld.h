/* Joining vertices that stand at the same place: glTF files split them where normals or texture
 * coordinates differ, and OBJ files may ask for it. Internal to server/cage/read. */
#ifndef SHEEN_CAGE_READ_WELD_H
#define SHEEN_CAGE_READ_WELD_H

#include "server/cage/read/builder.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What stood in the builder before that which is welded; it stays as it is. Zeros: nothing. */
struct weld_start {
    size_t vertices, face_vertices, creases, corners;
};

struct weld_start weld_begin(const struct cage_builder *builder);

/* Makes one vertex of all with exactly equal coordinates that came after `start`, in the order of
 * their first; linear in their number. No face or tag is dropped: cage_mend() does that, and warns,
 * where corners have become one. Vertices of faces that came after `start` must have too, and be in
 * range. ERROR_SERVER when memory is short. */
bool cage_weld(struct cage_builder *builder, const struct weld_start *start, const char *name,
               struct error *error);

#ifdef __cplusplus
}
#endif

#endif
