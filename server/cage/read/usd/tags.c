#include "server/cage/read/usd/mesh.h"

/* The lists of one kind of tag, read side by side. */
struct tags {
    struct usd_mesh *mesh;
    struct usd_list indices, lengths, sharpnesses;
};

static bool begin(struct usd_list *list, const struct usd_mesh *mesh, enum usd_property_kind kind,
                  const char *what)
{
    const struct usd_text text = usd_value(mesh->values, kind);
    return usd_list_begin(list, &text, what);
}

/* The line of a property, or of the prim if it does not have it. */
static uint32_t line_of(const struct usd_mesh *mesh, enum usd_property_kind kind)
{
    const struct usd_property *property = mesh->values->property[kind];
    return property ? property->name.line : mesh->values->prim->name.line;
}

/* Counts the elements of a list, which is a copy, and adds them up if `sum` is not NULL. */
static bool count(struct usd_list list, uint64_t *n, int64_t least, uint64_t *sum)
{
    bool more;
    int64_t number;
    *n = 0;
    for (;;) {
        if (!usd_list_next(&list, &more))
            return false;
        if (!more)
            return true;
        if (!sum) {
            if (!usd_skip_value(&list.text, NULL))
                return false;
        } else {
            if (!usd_integer(&list.text, list.what, &number))
                return false;
            if (number < least)
                return usd_fail(list.text.file, list.text.line, "%s has %lld, needs at least %lld",
                                list.what, (long long)number, (long long)least);
            /* At most 10^13 each, and less than 2^30 of them: no overflow. */
            *sum += (uint64_t)number;
        }
        ++*n;
    }
}

/* Reads the next index, which must be there. An index of no element becomes UINT32_MAX. */
static bool next_index(struct usd_list *list, size_t first, size_t n, uint32_t *index)
{
    bool more;
    int64_t number;
    if (!usd_list_next(list, &more) || !usd_integer(&list->text, list->what, &number))
        return false;
    *index = number >= 0 && (uint64_t)number < n ? (uint32_t)(first + (size_t)number) : UINT32_MAX;
    return true;
}

static bool next_sharpness(struct tags *tags, float *sharpness)
{
    bool more;
    return usd_list_next(&tags->sharpnesses, &more) &&
           usd_sharpness(&tags->sharpnesses.text, tags->sharpnesses.what, sharpness,
                         tags->mesh->has_negative);
}

static size_t n_vertices(const struct usd_mesh *mesh)
{
    return mesh->builder->cage.n_vertices - mesh->first_vertex;
}

/* Checks that the lists of creases fit together. *each_edge: there is one sharpness for each edge,
 * not one for each crease. */
static bool check_creases(const struct tags *tags, bool *each_edge)
{
    const struct usd_mesh *mesh = tags->mesh;
    uint64_t n_indices, n_creases, n_sharpnesses, sum = 0;
    if (!count(tags->indices, &n_indices, 0, NULL) || !count(tags->lengths, &n_creases, 2, &sum) ||
        !count(tags->sharpnesses, &n_sharpnesses, 0, NULL))
        return false;
    if (sum != n_indices)
        return usd_fail(mesh->file, line_of(mesh, USD_CREASE_LENGTHS),
                        "creaseLengths add up to %llu, but creaseIndices has %llu",
                        (unsigned long long)sum, (unsigned long long)n_indices);
    const uint64_t n_edges = n_indices - n_creases;
    *each_edge = n_sharpnesses != n_creases;
    return !*each_edge || n_sharpnesses == n_edges ||
           usd_fail(mesh->file, line_of(mesh, USD_CREASE_SHARPNESSES),
                    "%llu creaseSharpnesses for %llu creases of %llu edges: give one for each "
                    "crease, or one for each edge",
                    (unsigned long long)n_sharpnesses, (unsigned long long)n_creases,
                    (unsigned long long)n_edges);
}

/* Adds the edges of one crease of n vertices. */
static bool add_crease(struct tags *tags, int64_t n, bool each_edge)
{
    struct usd_mesh *mesh = tags->mesh;
    struct cage_crease crease = {.sharpness = 0};
    if (!next_index(&tags->indices, mesh->first_vertex, n_vertices(mesh), &crease.vertex[1]))
        return false;
    for (int64_t i = 1; i < n; i++) {
        crease.vertex[0] = crease.vertex[1];
        if (!next_index(&tags->indices, mesh->first_vertex, n_vertices(mesh), &crease.vertex[1]) ||
            ((i == 1 || each_edge) && !next_sharpness(tags, &crease.sharpness)) ||
            !cage_builder_crease(mesh->builder, &crease, tags->indices.text.line,
                                 mesh->file->error))
            return false;
    }
    return true;
}

static bool add_creases(struct usd_mesh *mesh)
{
    struct tags tags = {.mesh = mesh};
    bool each_edge = false, more;
    int64_t n;
    if (!begin(&tags.indices, mesh, USD_CREASE_INDICES, "creaseIndices") ||
        !begin(&tags.lengths, mesh, USD_CREASE_LENGTHS, "creaseLengths") ||
        !begin(&tags.sharpnesses, mesh, USD_CREASE_SHARPNESSES, "creaseSharpnesses") ||
        !check_creases(&tags, &each_edge))
        return false;
    for (;;) {
        if (!usd_list_next(&tags.lengths, &more))
            return false;
        if (!more)
            return true;
        if (!usd_integer(&tags.lengths.text, "creaseLengths", &n) ||
            !add_crease(&tags, n, each_edge))
            return false;
    }
}

static bool add_corners(struct usd_mesh *mesh)
{
    struct tags tags = {.mesh = mesh};
    uint64_t n_indices, n_sharpnesses;
    if (!begin(&tags.indices, mesh, USD_CORNER_INDICES, "cornerIndices") ||
        !begin(&tags.sharpnesses, mesh, USD_CORNER_SHARPNESSES, "cornerSharpnesses") ||
        !count(tags.indices, &n_indices, 0, NULL) ||
        !count(tags.sharpnesses, &n_sharpnesses, 0, NULL))
        return false;
    if (n_indices != n_sharpnesses)
        return usd_fail(mesh->file, line_of(mesh, USD_CORNER_SHARPNESSES),
                        "%llu cornerSharpnesses for %llu cornerIndices",
                        (unsigned long long)n_sharpnesses, (unsigned long long)n_indices);
    for (uint64_t i = 0; i < n_indices; i++) {
        struct cage_corner corner;
        if (!next_index(&tags.indices, mesh->first_vertex, n_vertices(mesh), &corner.vertex) ||
            !next_sharpness(&tags, &corner.sharpness) ||
            !cage_builder_corner(mesh->builder, &corner, tags.indices.text.line, mesh->file->error))
            return false;
    }
    return true;
}

static bool add_holes(struct usd_mesh *mesh)
{
    const size_t n_faces = mesh->builder->cage.n_faces - mesh->first_face;
    struct usd_list list;
    uint64_t n;
    uint32_t face;
    if (!begin(&list, mesh, USD_HOLE_INDICES, "holeIndices") || !count(list, &n, 0, NULL))
        return false;
    for (uint64_t i = 0; i < n; i++)
        if (!next_index(&list, mesh->first_face, n_faces, &face) ||
            !cage_builder_hole(mesh->builder, face, list.text.line, mesh->file->error))
            return false;
    return true;
}

bool usd_add_tags(struct usd_mesh *mesh)
{
    return add_creases(mesh) && add_corners(mesh) && add_holes(mesh);
}
