/* The control cage as data: vertices, faces and subdivision tags as read from a file, with damaged
 * elements taken out (build/repair.h) and equal positions joined where that was asked for or the
 * format has it so (build/weld.h).
 *
 * A cage is plain memory that its owner frees with cage_finish(). Nothing here evaluates anything;
 * the limit surface is built by server/surface. Thread: a cage is read-only once read and may then
 * be shared. All indices are zero-based and have been checked by cage_check(). */
#ifndef SHEEN_CAGE_CAGE_H
#define SHEEN_CAGE_CAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

/* Sharpness of this much and more is infinite (OpenSubdiv sdc/crease.h). */
#define CAGE_SHARPNESS_INFINITE 10.0f
/* Largest counts accepted: (face, corner) pairs must fit 31 bits. */
#define CAGE_MAX_VERTICES 100000000u
#define CAGE_MAX_FACES 50000000u
#define CAGE_MAX_CORNERS 400000000u
/* Largest absolute coordinate, in file units: squares and cubes of it stay finite in double and
 * differences stay finite in single precision. */
#define CAGE_MAX_COORDINATE 1e30
/* The most bytes of cage.warnings, with the final 0. */
#define CAGE_WARNINGS_BYTES 4096
/* cage_finding.face where the finding is at no face. */
#define CAGE_NO_FACE UINT32_MAX

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

/* Which of its axes a file says is up. */
enum cage_up { CAGE_UP_UNSAID, CAGE_UP_X, CAGE_UP_Y, CAGE_UP_Z };

struct cage_crease {
    uint32_t vertex[2]; /* end vertices of the edge */
    float sharpness;    /* >= 0, CAGE_SHARPNESS_INFINITE and more is infinite */
};

struct cage_corner {
    uint32_t vertex;
    float sharpness; /* as cage_crease.sharpness */
};

/* What reading found: first kinds of damage, for which elements are left out, then kinds of
 * what is probably not meant but drawn as it is. Each finding has a warning that says the same
 * in words. */
enum cage_finding_kind {
    /* Damage (build/repair.h). */
    CAGE_FOUND_REPEATED_CORNER, /* faces that lost a corner which repeats its neighbour */
    CAGE_FOUND_FEW_CORNERS,     /* faces passed over: fewer than three different corners */
    CAGE_FOUND_KEYHOLE, /* faces passed over: one vertex at corners that are no neighbours */
    CAGE_FOUND_CREASE,  /* creases passed over: on no edge */
    CAGE_FOUND_CORNER,  /* corner tags passed over: on no vertex */
    CAGE_FOUND_HOLE,    /* holes passed over: of no face */
    /* Probably not meant (build/inspect.h). */
    CAGE_FOUND_UNWELDED,   /* corners at the position of another, though no face shares a vertex */
    CAGE_FOUND_TRIANGLES,  /* faces that are plain triangles */
    CAGE_FOUND_WOUND,      /* edges that two faces run along in one direction */
    CAGE_FOUND_FACE_TWICE, /* faces that repeat an earlier one */
    CAGE_FOUND_INSIDE_OUT, /* closed bodies whose faces turn inwards */
    N_CAGE_FINDINGS,
};

struct cage_finding {
    enum cage_finding_kind kind;
    uint32_t count; /* of what the kind says, from 1 */
    uint32_t line;  /* of the file, from 1: where the first is; 0: it has no such place */
    uint32_t face;  /* where the file has no lines, the first face, from 0, else CAGE_NO_FACE */
};

struct cage {
    size_t n_vertices;
    double (*position)[3]; /* [n_vertices], file units, finite */

    size_t n_faces;
    uint32_t *face_start; /* [n_faces + 1], offsets into face_vertex; face_start[n_faces] corners */
    uint32_t *face_vertex; /* corners in file order: counter-clockwise seen from outside */

    enum cage_scheme scheme;
    enum cage_boundary boundary;
    enum cage_up up;       /* of the world that the positions are in; changes no surface */
    bool chaikin;          /* creasemethod chaikin */
    bool smooth_triangles; /* smoothtriangles smooth */

    size_t n_creases;
    struct cage_crease *crease;
    size_t n_corners;
    struct cage_corner *corner;
    size_t n_holes;
    uint32_t *hole; /* face indices */

    /* What the user should know: every finding, and what was passed over (unknown tags). Lines
     * joined by '\n', or NULL; at most CAGE_WARNINGS_BYTES with the final 0; owned by the cage. */
    char *warnings;
    size_t n_findings;
    struct cage_finding finding[N_CAGE_FINDINGS]; /* at most one of each kind */
};

/* Frees what the cage owns and zeroes it. Safe on a zeroed cage. */
void cage_finish(struct cage *cage);

/* Whether every index is in range, every face has 3 or more different corners, every coordinate
 * is finite and within CAGE_MAX_COORDINATE, there is a face, counts are within limits,
 * sharpness is finite and >= 0, creases lie on edges, corners and holes are in range. False:
 * ERROR_MODEL, whose text names `name` and the element; ERROR_SERVER when memory is short. */
bool cage_check(const struct cage *cage, const char *name, struct error *error);

/* Appends one line to cage->warnings. Once these are full their last line says that more
 * warnings followed, and further lines are dropped. */
void cage_warn(struct cage *cage, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Keeps a finding and warns of it in one line: its place ("NAME:LINE: ", or the face, or the
 * name alone) and the text. A second finding of a kind is dropped: callers count and report
 * each kind once. */
void cage_found(struct cage *cage, const struct cage_finding *finding, const char *name,
                const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
