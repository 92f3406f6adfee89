/* A model as data: a control cage, which is vertices, faces and subdivision tags, or patches, as
 * read from a file. Readers remove damaged elements (build/repair.h), and join vertices at equal
 * positions where the format or the user says so (build/weld.h).
 *
 * A cage is plain memory; its owner frees it by cage_finish(). Nothing is evaluated here:
 * server/surface builds the limit surface. All indices count from 0 and have been checked by
 * cage_check().
 * Thread: once read, a cage is read-only and may be shared. */
#ifndef SHEEN_CAGE_CAGE_H
#define SHEEN_CAGE_CAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/cage/patch.h"

/* Sharpness from this value on is infinite (OpenSubdiv sdc/crease.h). */
#define CAGE_SHARPNESS_INFINITE 10.0f
/* The largest counts that are accepted: (face, corner) pairs must fit in 31 bits. */
#define CAGE_MAX_VERTICES 100000000u
#define CAGE_MAX_FACES 50000000u
#define CAGE_MAX_CORNERS 400000000u
#define CAGE_MAX_PATCHES 10000000u
/* The largest magnitude of a coordinate, in file units: its square and cube are finite in double
 * precision, and differences are finite in single precision. */
#define CAGE_MAX_COORDINATE 1e30
/* The largest size of cage.warnings, with the final 0. */
#define CAGE_WARNINGS_BYTES 4096
/* cage_finding.face if the finding has no face. */
#define CAGE_NO_FACE UINT32_MAX

/* Boundary interpolation (OpenSubdiv Sdc::Options::VtxBoundaryInterpolation). */
enum cage_boundary {
    CAGE_BOUNDARY_EDGE_ONLY, /* the default: boundary edges are infinitely sharp, corners smooth */
    CAGE_BOUNDARY_EDGE_AND_CORNER,
    CAGE_BOUNDARY_NONE, /* faces at a boundary have no surface, but support their neighbours */
};

enum cage_scheme {
    CAGE_SCHEME_CATMULL_CLARK,
    CAGE_SCHEME_LOOP,
    CAGE_SCHEME_BILINEAR,
};

/* The axis that a file declares as up. */
enum cage_up { CAGE_UP_UNSAID, CAGE_UP_X, CAGE_UP_Y, CAGE_UP_Z };

struct cage_crease {
    uint32_t vertex[2]; /* end vertices of the edge */
    float sharpness;    /* at least 0; infinite from CAGE_SHARPNESS_INFINITE on */
};

struct cage_corner {
    uint32_t vertex;
    float sharpness; /* as cage_crease.sharpness */
};

/* What a reader found: first kinds of damage, for which elements are left out; then kinds that are
 * drawn as they are but probably not meant. Each finding has a warning in words. */
enum cage_finding_kind {
    /* Damage (build/repair.h). */
    CAGE_FOUND_REPEATED_CORNER, /* faces with a corner equal to the next one, which is dropped */
    CAGE_FOUND_FEW_CORNERS,     /* faces left out: fewer than three different corners */
    CAGE_FOUND_KEYHOLE, /* faces left out: one vertex at two corners that are not adjacent */
    CAGE_FOUND_CREASE,  /* creases left out: no such edge */
    CAGE_FOUND_CORNER,  /* corner tags left out: no such vertex */
    CAGE_FOUND_HOLE,    /* holes left out: no such face */
    /* Probably not meant (build/inspect.h). */
    CAGE_FOUND_UNWELDED,   /* positions that repeat, in a cage whose faces share no vertices */
    CAGE_FOUND_TRIANGLES,  /* faces that are plain triangles */
    CAGE_FOUND_WOUND,      /* edges that two faces traverse in the same direction */
    CAGE_FOUND_FACE_TWICE, /* faces that repeat an earlier one */
    CAGE_FOUND_INSIDE_OUT, /* closed bodies whose normals point inwards */
    N_CAGE_FINDINGS,
};

struct cage_finding {
    enum cage_finding_kind kind;
    uint32_t count; /* how many, from 1 */
    uint32_t line;  /* line in the file of the first one, from 1; 0: unknown */
    uint32_t face;  /* if the file has no lines: the first face, from 0; else CAGE_NO_FACE */
};

struct cage {
    size_t n_vertices;
    double (*position)[3]; /* [n_vertices], file units, finite */

    size_t n_faces;
    uint32_t *face_start; /* [n_faces + 1], offsets into face_vertex; face_start[n_faces] corners */
    uint32_t *face_vertex; /* corners in file order: counter-clockwise seen from outside */

    enum cage_scheme scheme;
    enum cage_boundary boundary;
    enum cage_up up;       /* up direction of the positions; does not change the surface */
    bool chaikin;          /* creasemethod chaikin */
    bool smooth_triangles; /* smoothtriangles smooth */

    size_t n_creases;
    struct cage_crease *crease;
    size_t n_corners;
    struct cage_corner *corner;
    size_t n_holes;
    uint32_t *hole; /* face indices */

    /* A model of patches has no vertex, face or tag, but face_start, with one entry. */
    size_t n_patches;
    struct cage_patch *patch;

    /* Warnings for the user: all findings, and unknown tags that were ignored. Lines separated by
     * '\n', or NULL; at most CAGE_WARNINGS_BYTES with the final 0; owned by the cage. */
    char *warnings;
    size_t n_findings;
    struct cage_finding finding[N_CAGE_FINDINGS]; /* at most one of each kind */
};

/* Frees what the cage owns and zeroes it. Safe on a zeroed cage. */
void cage_finish(struct cage *cage);

/* Checks that every index is in range, every face has 3 or more different corners, every coordinate
 * is finite and within CAGE_MAX_COORDINATE, there are faces or patches but not both, counts are
 * within limits, sharpness is finite and at least 0, creases lie on edges, and patches have a known
 * basis. False with ERROR_MODEL, which names `name` and the element, or with ERROR_SERVER when
 * memory is short. */
bool cage_check(const struct cage *cage, const char *name, struct error *error);

/* Appends one line to cage->warnings. When they are full, their last line says that more warnings
 * followed, and further lines are dropped. */
void cage_warn(struct cage *cage, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Keeps a finding and adds its warning: one line with the place ("NAME:LINE: ", or the face, or
 * only the name) and the text. A second finding of the same kind is dropped: callers count, and
 * report each kind once. */
void cage_found(struct cage *cage, const struct cage_finding *finding, const char *name,
                const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
