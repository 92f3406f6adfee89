/* The control cage as data: vertices, faces and subdivision tags, exactly as a file says them.
 *
 * A cage is plain memory that its owner frees with cage_finish(). Nothing here evaluates anything;
 * the limit surface is built by server/limit. Thread: a cage is read-only once read and may then
 * be shared. All indices are zero-based and have been checked by cage_check(). */
#ifndef SHEEN_CAGE_CAGE_H
#define SHEEN_CAGE_CAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/error.h"

/* Sharpness of this much and more is infinite (OpenSubdiv sdc/crease.h). */
#define CAGE_SHARPNESS_INFINITE 10.0f
/* Largest counts accepted: (face, corner) pairs must fit 31 bits. */
#define CAGE_MAX_VERTICES 100000000u
#define CAGE_MAX_FACES 50000000u
#define CAGE_MAX_CORNERS 400000000u
/* Largest absolute coordinate, in file units: squares and cubes of it stay finite in double and
 * differences stay finite in single precision. */
#define CAGE_MAX_COORDINATE 1e30
/* Of cage.warnings, with its end. */
#define CAGE_WARNINGS_BYTES 4096

/* Boundary interpolation (OpenSubdiv Sdc::Options::VtxBoundaryInterpolation). */
enum cage_boundary {
    CAGE_BOUNDARY_EDGE_ONLY, /* boundary edges infinitely sharp, corners smooth: the default */
    CAGE_BOUNDARY_EDGE_AND_CORNER,
    CAGE_BOUNDARY_NONE, /* faces at a boundary are support only: no surface there */
};

enum cage_scheme {
    CAGE_SCHEME_CATMULL_CLARK,
    CAGE_SCHEME_LOOP,
    CAGE_SCHEME_BILINEAR,
};

struct cage_crease {
    uint32_t vertex[2]; /* end vertices of the edge */
    float sharpness;    /* >= 0, CAGE_SHARPNESS_INFINITE and more is infinite */
};

struct cage_corner {
    uint32_t vertex;
    float sharpness; /* as cage_crease.sharpness */
};

struct cage {
    size_t n_vertices;
    double (*position)[3]; /* [n_vertices], file units, finite */

    size_t n_faces;
    uint32_t *face_start; /* [n_faces + 1], offsets into face_vertex; face_start[n_faces] corners */
    uint32_t *face_vertex; /* corners in file order: counter-clockwise seen from outside */

    enum cage_scheme scheme;
    enum cage_boundary boundary;
    bool chaikin;          /* creasemethod chaikin */
    bool smooth_triangles; /* smoothtriangles smooth */

    size_t n_creases;
    struct cage_crease *crease;
    size_t n_corners;
    struct cage_corner *corner;
    size_t n_holes;
    uint32_t *hole; /* face indices */

    /* Things the user should know (ignored tags, a plain triangle mesh): lines joined by '\n',
     * or NULL. At most CAGE_WARNINGS_BYTES; owned by the cage. */
    char *warnings;
};

/* Frees what the cage owns and zeroes it. Safe on a zeroed cage. */
void cage_finish(struct cage *cage);

/* Every index in range, every face with 3 or more different corners, every coordinate finite and
 * within CAGE_MAX_COORDINATE, at least one face, counts within limits, sharpness finite and >= 0,
 * creases on existing edges, corners and holes in range. Error texts name `name`. */
bool cage_check(const struct cage *cage, const char *name, struct error *error);

/* Appends one line to cage->warnings (dropped silently once they are full, the last line then says
 * that more followed). */
void cage_warn(struct cage *cage, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
