/* A cage under construction: arrays that grow while a reader walks through a file, and the line of
 * each element, so that later warnings can name it.
 *
 * The caller owns the struct. Zero it, set the name, pass it to a reader, then take `cage` out (and
 * zero it) or keep nothing; in both cases call cage_builder_finish(). Functions that return bool
 * fail with ERROR_SERVER when memory is short, and with ERROR_MODEL when a count exceeds its
 * CAGE_MAX_ limit; the builder stays valid.
 * Thread: one at a time. */
#ifndef SHEEN_CAGE_BUILD_BUILDER_H
#define SHEEN_CAGE_BUILD_BUILDER_H

#include "server/cage/cage.h"

struct cage_builder {
    struct cage cage;
    const char *name; /* name of the file, for messages; owned by the caller */
    /* The line in the file (from 1) of each face, crease, corner tag and hole; 0 if the file has no
     * lines. As long as the arrays of `cage`. */
    uint32_t *face_line, *crease_line, *corner_line, *hole_line;

    /* The file asks to join vertices at equal positions. */
    bool weld;
    /* The file has triangles, and nothing in it says that triangles are intended. */
    bool plain_triangles;

    /* Length of cage.face_vertex: the corners of finished faces and of the face under
     * construction. */
    size_t n_face_vertices;

    size_t vertex_capacity, face_capacity, face_vertex_capacity;
    size_t crease_capacity, corner_capacity, hole_capacity, patch_capacity;
};

void cage_builder_finish(struct cage_builder *builder);

bool cage_builder_vertex(struct cage_builder *builder, const double position[3],
                         struct error *error);
/* Adds a corner to the face under construction; cage_builder_end_face() ends the face. Only counts
 * are checked here; cage_repair() and cage_check() check the whole cage. */
bool cage_builder_face_vertex(struct cage_builder *builder, uint32_t vertex, struct error *error);
bool cage_builder_end_face(struct cage_builder *builder, uint32_t line, struct error *error);

bool cage_builder_crease(struct cage_builder *builder, const struct cage_crease *crease,
                         uint32_t line, struct error *error);
bool cage_builder_corner(struct cage_builder *builder, const struct cage_corner *corner,
                         uint32_t line, struct error *error);
/* Adds a patch; cage_check() checks its basis and points. */
bool cage_builder_patch(struct cage_builder *builder, const struct cage_patch *patch,
                        struct error *error);

bool cage_builder_hole(struct cage_builder *builder, uint32_t face, uint32_t line,
                       struct error *error);

/* True if there are faces, more than one, and all are triangles: in a format that has larger faces,
 * they may not be intended. */
bool cage_builder_has_triangles_alone(const struct cage_builder *builder);

#endif
