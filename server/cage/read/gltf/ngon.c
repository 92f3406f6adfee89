#include "server/cage/read/gltf/ngon.h"

/* The number of triangles, from the first one on, that are one polygon. */
static size_t fan_length(const struct ngon_triangles *triangles, size_t first, size_t *n_breaks)
{
    const uint32_t *index = triangles->index;
    size_t next = first + 1;
    while (triangles->encoded && next < triangles->n && index[3 * next] == index[3 * first]) {
        if (index[3 * next + 1] != index[3 * next - 1]) {
            (*n_breaks)++;
            break;
        }
        next++;
    }
    return next - first;
}

bool ngon_add_faces(struct cage_builder *builder, const struct ngon_triangles *triangles,
                    size_t *n_breaks, struct error *error)
{
    for (size_t t = 0; t < triangles->n;) {
        const uint32_t *fan = &triangles->index[3 * t];
        size_t length = fan_length(triangles, t, n_breaks);
        size_t n = length + 2;
        for (size_t c = 0; c < n; c++) {
            size_t corner = triangles->mirrored && c > 0 ? n - c : c;
            uint32_t vertex = corner < 2 ? fan[corner] : fan[3 * (corner - 2) + 2];
            if (!cage_builder_face_vertex(builder, triangles->base + vertex, error))
                return false;
        }
        if (!cage_builder_end_face(builder, 0, error))
            return false;
        t += length;
    }
    return true;
}
