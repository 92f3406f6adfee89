#include "server/cage/build/builder.h"

#include <stdlib.h>

/* A limit of tags: the largest cage has no more corners. */
#define MAX_TAGS CAGE_MAX_CORNERS

/* Returns `array` with room for one more element after `count`; NULL, and the array unchanged, when
 * memory is short. It grows by half, so that copying takes linear time and little memory is
 * wasted. */
static void *room_for_one(void *array, size_t count, size_t capacity, size_t *new_capacity,
                          size_t element)
{
    *new_capacity = capacity;
    if (count < capacity)
        return array;
    size_t wanted = capacity < 64 ? 64 : capacity + capacity / 2;
    size_t bytes;
    if (__builtin_mul_overflow(wanted, element, &bytes))
        return NULL;
    void *grown = realloc(array, bytes);
    if (grown)
        *new_capacity = wanted;
    return grown;
}

static const char *name_of(const struct cage_builder *builder)
{
    return builder->name ? builder->name : "cage";
}

static bool no_memory(const struct cage_builder *builder, const char *what, size_t count,
                      struct error *error)
{
    return error_set(error, ERROR_SERVER, "%s: not enough memory for %zu %s", name_of(builder),
                     count, what);
}

static bool too_many(const struct cage_builder *builder, const char *what, size_t limit,
                     struct error *error)
{
    return error_set(error, ERROR_MODEL, "%s: the cage has more than %zu %s, the most that is read",
                     name_of(builder), limit, what);
}

void cage_builder_finish(struct cage_builder *builder)
{
    cage_finish(&builder->cage);
    free(builder->face_line);
    free(builder->crease_line);
    free(builder->corner_line);
    free(builder->hole_line);
    *builder = (struct cage_builder){0};
}

bool cage_builder_vertex(struct cage_builder *builder, const double position[3],
                         struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_vertices >= CAGE_MAX_VERTICES)
        return too_many(builder, "vertices", CAGE_MAX_VERTICES, error);
    double(*grown)[3] = room_for_one(cage->position, cage->n_vertices, builder->vertex_capacity,
                                     &builder->vertex_capacity, sizeof *grown);
    if (!grown)
        return no_memory(builder, "vertices", cage->n_vertices, error);
    cage->position = grown;
    for (int i = 0; i < 3; i++)
        grown[cage->n_vertices][i] = position[i];
    cage->n_vertices++;
    return true;
}

bool cage_builder_face_vertex(struct cage_builder *builder, uint32_t vertex, struct error *error)
{
    struct cage *cage = &builder->cage;
    if (builder->n_face_vertices >= CAGE_MAX_CORNERS)
        return too_many(builder, "face corners", CAGE_MAX_CORNERS, error);
    uint32_t *grown =
        room_for_one(cage->face_vertex, builder->n_face_vertices, builder->face_vertex_capacity,
                     &builder->face_vertex_capacity, sizeof *grown);
    if (!grown)
        return no_memory(builder, "face corners", builder->n_face_vertices, error);
    cage->face_vertex = grown;
    grown[builder->n_face_vertices++] = vertex;
    return true;
}

bool cage_builder_end_face(struct cage_builder *builder, uint32_t line, struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_faces >= CAGE_MAX_FACES)
        return too_many(builder, "faces", CAGE_MAX_FACES, error);
    size_t capacity;
    uint32_t *lines = room_for_one(builder->face_line, cage->n_faces, builder->face_capacity,
                                   &capacity, sizeof *lines);
    if (!lines)
        return no_memory(builder, "faces", cage->n_faces, error);
    builder->face_line = lines;
    if (capacity != builder->face_capacity) {
        uint32_t *start = realloc(cage->face_start, (capacity + 1) * sizeof *start);
        if (!start)
            return no_memory(builder, "faces", cage->n_faces, error);
        cage->face_start = start;
        builder->face_capacity = capacity;
    }
    lines[cage->n_faces] = line;
    cage->face_start[0] = 0;
    cage->face_start[++cage->n_faces] = (uint32_t)builder->n_face_vertices;
    return true;
}

/* Makes room for one more tag in an array and in the array of its lines. False: no memory. */
static bool room_for_tag(void **tags, size_t element, uint32_t **lines, size_t count,
                         size_t *capacity)
{
    size_t grown_capacity;
    void *grown = room_for_one(*tags, count, *capacity, &grown_capacity, element);
    if (!grown)
        return false;
    *tags = grown;
    uint32_t *grown_lines =
        room_for_one(*lines, count, *capacity, &grown_capacity, sizeof *grown_lines);
    if (!grown_lines)
        return false;
    *lines = grown_lines;
    *capacity = grown_capacity;
    return true;
}

bool cage_builder_crease(struct cage_builder *builder, const struct cage_crease *crease,
                         uint32_t line, struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_creases >= MAX_TAGS)
        return too_many(builder, "creases", MAX_TAGS, error);
    void *tags = cage->crease;
    bool ok = room_for_tag(&tags, sizeof *crease, &builder->crease_line, cage->n_creases,
                           &builder->crease_capacity);
    cage->crease = tags;
    if (!ok)
        return no_memory(builder, "creases", cage->n_creases, error);
    builder->crease_line[cage->n_creases] = line;
    cage->crease[cage->n_creases++] = *crease;
    return true;
}

bool cage_builder_corner(struct cage_builder *builder, const struct cage_corner *corner,
                         uint32_t line, struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_corners >= MAX_TAGS)
        return too_many(builder, "corner tags", MAX_TAGS, error);
    void *tags = cage->corner;
    bool ok = room_for_tag(&tags, sizeof *corner, &builder->corner_line, cage->n_corners,
                           &builder->corner_capacity);
    cage->corner = tags;
    if (!ok)
        return no_memory(builder, "corner tags", cage->n_corners, error);
    builder->corner_line[cage->n_corners] = line;
    cage->corner[cage->n_corners++] = *corner;
    return true;
}

bool cage_builder_hole(struct cage_builder *builder, uint32_t face, uint32_t line,
                       struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_holes >= MAX_TAGS)
        return too_many(builder, "holes", MAX_TAGS, error);
    void *tags = cage->hole;
    bool ok = room_for_tag(&tags, sizeof face, &builder->hole_line, cage->n_holes,
                           &builder->hole_capacity);
    cage->hole = tags;
    if (!ok)
        return no_memory(builder, "holes", cage->n_holes, error);
    builder->hole_line[cage->n_holes] = line;
    cage->hole[cage->n_holes++] = face;
    return true;
}

bool cage_builder_has_triangles_alone(const struct cage_builder *builder)
{
    const struct cage *cage = &builder->cage;
    for (size_t f = 0; f < cage->n_faces; f++)
        if (cage->face_start[f + 1] - cage->face_start[f] != 3)
            return false;
    return cage->n_faces > 1;
}

bool cage_builder_patch(struct cage_builder *builder, const struct cage_patch *patch,
                        struct error *error)
{
    struct cage *cage = &builder->cage;
    if (cage->n_patches >= CAGE_MAX_PATCHES)
        return too_many(builder, "patches", CAGE_MAX_PATCHES, error);
    struct cage_patch *grown = room_for_one(cage->patch, cage->n_patches, builder->patch_capacity,
                                            &builder->patch_capacity, sizeof *grown);
    if (grown)
        cage->patch = grown;
    /* Every cage has face_start, also without faces. */
    if (!cage->face_start)
        cage->face_start = calloc(1, sizeof *cage->face_start);
    if (!grown || !cage->face_start)
        return no_memory(builder, "patches", cage->n_patches, error);
    grown[cage->n_patches++] = *patch;
    return true;
}
