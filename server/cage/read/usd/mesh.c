#include "server/cage/read/usd/mesh.h"

#include <math.h>
#include <stdlib.h>

/* --- points */

static bool check_point(const struct usd_mesh *mesh, const double point[3], uint32_t line)
{
    for (int i = 0; i < 3; i++) {
        if (!isfinite(point[i]))
            return usd_fail(mesh->file, line, "a point is not finite where its prims put it");
        if (fabs(point[i]) > CAGE_MAX_COORDINATE)
            return usd_fail(mesh->file, line,
                            "coordinate %c of a point is %g, beyond the largest that is read, %g",
                            "xyz"[i], point[i], CAGE_MAX_COORDINATE);
    }
    return true;
}

static bool add_points(struct usd_mesh *mesh)
{
    const struct usd_text points = usd_value(mesh->values, USD_POINTS);
    struct usd_list list;
    bool more;
    if (!usd_list_begin(&list, &points, "points"))
        return false;
    for (;;) {
        double local[3], world[3];
        if (!usd_list_next(&list, &more))
            return false;
        if (!more)
            return true;
        if (!usd_tuple(&list.text, "a point", 3, local))
            return false;
        if (mesh->is_placed)
            transform_point(mesh->world, local, world);
        const double *point = mesh->is_placed ? world : local;
        if (!check_point(mesh, point, list.text.line) ||
            !cage_builder_vertex(mesh->builder, point, mesh->file->error))
            return false;
    }
}

/* --- faces */

/* Reads the next of faceVertexIndices and adds it as a corner. */
static bool add_corner(struct usd_mesh *mesh, struct usd_list *indices, size_t n_points,
                       uint32_t line)
{
    bool more;
    int64_t index;
    if (!usd_list_next(indices, &more))
        return false;
    if (!more)
        return usd_fail(mesh->file, line,
                        "faceVertexIndices ends before the last corner that faceVertexCounts has");
    if (!usd_integer(&indices->text, "faceVertexIndices", &index))
        return false;
    if (index < 0 || (uint64_t)index >= n_points)
        return usd_fail(mesh->file, indices->text.line,
                        "faceVertexIndices has %lld, but the mesh has %zu points", (long long)index,
                        n_points);
    return cage_builder_face_vertex(mesh->builder, (uint32_t)(mesh->first_vertex + (size_t)index),
                                    mesh->file->error);
}

/* Reverses the corners of the face under construction except the first. */
static void turn_face(struct cage_builder *builder, size_t first)
{
    uint32_t *corner = builder->cage.face_vertex;
    if (builder->n_face_vertices == first)
        return;
    for (size_t a = first + 1, b = builder->n_face_vertices - 1; a < b; a++, b--) {
        const uint32_t kept = corner[a];
        corner[a] = corner[b];
        corner[b] = kept;
    }
}

static bool add_face(struct usd_mesh *mesh, struct usd_list *indices, int64_t n_corners,
                     size_t n_points)
{
    struct cage_builder *builder = mesh->builder;
    const size_t first = builder->n_face_vertices;
    uint32_t line = indices->text.line;
    for (int64_t c = 0; c < n_corners; c++) {
        if (!add_corner(mesh, indices, n_points, line))
            return false;
        if (c == 0)
            line = indices->text.line; /* the face stands where its first corner does */
    }
    if (mesh->turn_faces)
        turn_face(builder, first);
    mesh->has_triangle |= n_corners == 3;
    return cage_builder_end_face(builder, line, mesh->file->error);
}

static bool add_faces(struct usd_mesh *mesh)
{
    const struct usd_text counts_at = usd_value(mesh->values, USD_FACE_VERTEX_COUNTS);
    const struct usd_text indices_at = usd_value(mesh->values, USD_FACE_VERTEX_INDICES);
    const size_t n_points = mesh->builder->cage.n_vertices - mesh->first_vertex;
    struct usd_list counts, indices;
    bool more;
    int64_t n_corners;
    if (!usd_list_begin(&counts, &counts_at, "faceVertexCounts") ||
        !usd_list_begin(&indices, &indices_at, "faceVertexIndices"))
        return false;
    for (;;) {
        if (!usd_list_next(&counts, &more))
            return false;
        if (!more)
            break;
        if (!usd_integer(&counts.text, "faceVertexCounts", &n_corners))
            return false;
        if (n_corners < 0)
            return usd_fail(mesh->file, counts.text.line, "faceVertexCounts has %lld, below 0",
                            (long long)n_corners);
        if (!add_face(mesh, &indices, n_corners, n_points))
            return false;
    }
    return usd_list_next(&indices, &more) &&
           (!more || usd_fail(mesh->file, indices.text.line,
                              "faceVertexIndices has more corners than faceVertexCounts"));
}

/* --- corners that the boundary makes sharp */

/* Tags the vertices of one face, which interpolateBoundary edgeAndCorner makes sharp, so that a
 * cage of several meshes needs no common setting. Tags come after those of the mesh, because the
 * last tag of a vertex counts. */
static bool tag_corners(struct usd_mesh *mesh)
{
    const struct cage *cage = &mesh->builder->cage;
    const size_t n = cage->n_vertices - mesh->first_vertex;
    const uint32_t line = mesh->values->prim->name.line;
    struct {
        uint32_t n_faces, last; /* last: 1 + the face that was counted last */
    } *vertex = calloc(n + 1, sizeof *vertex);
    if (!vertex)
        return error_set(mesh->file->error, ERROR_SERVER, "%s: not enough memory for %zu points",
                         mesh->file->name, n);
    for (uint32_t f = (uint32_t)mesh->first_face; f < cage->n_faces; f++) {
        for (uint32_t c = cage->face_start[f]; c < cage->face_start[f + 1]; c++) {
            const size_t v = cage->face_vertex[c] - mesh->first_vertex;
            vertex[v].n_faces += vertex[v].last != f + 1;
            vertex[v].last = f + 1;
        }
    }
    bool ok = true;
    for (size_t v = 0; ok && v < n; v++) {
        const struct cage_corner corner = {(uint32_t)(mesh->first_vertex + v),
                                           CAGE_SHARPNESS_INFINITE};
        ok = vertex[v].n_faces != 1 ||
             cage_builder_corner(mesh->builder, &corner, line, mesh->file->error);
    }
    free(vertex);
    return ok;
}

bool usd_add_mesh(struct usd_mesh *mesh)
{
    mesh->first_vertex = mesh->builder->cage.n_vertices;
    mesh->first_face = mesh->builder->cage.n_faces;
    return add_points(mesh) && add_faces(mesh) && usd_add_tags(mesh) &&
           (!mesh->sharp_corners || tag_corners(mesh));
}
