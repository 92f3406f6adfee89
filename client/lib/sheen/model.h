/* What the daemon knows about a model: its cage, its cost, and probable mistakes. sheen.h has the
 * rules. */
#ifndef SHEEN_PUBLIC_MODEL_H
#define SHEEN_PUBLIC_MODEL_H

#include "base.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

/* Properties of a model that are probably mistakes. `warnings` describes each in words. */
enum sheen_finding_kind {
    /* Faces with two equal corners in a row, of which the second is dropped. */
    SHEEN_FINDING_REPEATED_CORNER,
    SHEEN_FINDING_FEW_CORNERS, /* faces left out: fewer than three different corners */
    /* Faces left out: a vertex occurs at two corners that are not adjacent. */
    SHEEN_FINDING_KEYHOLE,
    SHEEN_FINDING_CREASE_WITHOUT_EDGE,   /* creases left out: no such edge */
    SHEEN_FINDING_CORNER_WITHOUT_VERTEX, /* sharp vertices left out: no such vertex */
    SHEEN_FINDING_HOLE_WITHOUT_FACE,     /* holes left out: no such face */
    SHEEN_FINDING_UNWELDED,  /* positions that repeat, in a model whose faces share no vertices */
    SHEEN_FINDING_TRIANGLES, /* faces that are plain triangles */
    SHEEN_FINDING_WOUND_AGAINST, /* edges that two faces traverse in the same direction */
    SHEEN_FINDING_FACE_TWICE,    /* faces that occur twice */
    SHEEN_FINDING_INSIDE_OUT,    /* closed bodies whose normals point inwards */
    SHEEN_FINDING_OTHER,         /* a kind that this library does not know */
};

struct sheen_finding {
    enum sheen_finding_kind kind;
    uint32_t count; /* how many, from 1 */
    uint32_t line;  /* line in the file of the first one, from 1; 0: unknown */
    bool has_face;  /* the file has no lines, so `face` is set */
    uint32_t face;  /* the first face, from 0 */
};

struct sheen_valence {
    uint32_t valence, count;
};

#define SHEEN_MAX_FINDINGS 16
#define SHEEN_MAX_VALENCES 64
struct sheen_model_info {
    size_t size;
    uint8_t id[SHEEN_ID_BYTES];
    char name[256];
    uint64_t file_bytes;
    uint32_t vertices, faces, triangles, quads, ngons; /* of the cage */
    uint32_t ptex_faces, boundary_edges;
    /* Entries of `extraordinary`; if there are more valences, the last entry sums the rest. */
    uint32_t n_valences;
    struct sheen_valence
        extraordinary[SHEEN_MAX_VALENCES]; /* interior vertices that do not have 4 edges */
    uint32_t boundary_extraordinary;       /* boundary vertices that do not have 2 faces */
    uint32_t sharp_edges, semisharp_edges; /* creases: infinitely sharp; of finite sharpness */
    uint32_t sharp_vertices;               /* vertices with a sharpness of their own */
    uint32_t holes;                        /* faces that are holes */
    /* Edges of 3 or more faces, or that 2 faces traverse in the same direction. */
    uint32_t nonmanifold_edges;
    uint32_t nonmanifold_vertices; /* vertices whose faces are not a single fan */
    uint32_t regular_patches, corner_patches, strip_patches, split_nodes, hole_nodes;
    /* Memory of the tables: on the device, or in main memory where processors draw. */
    uint64_t table_bytes;
    uint64_t regular_bytes, corner_bytes; /* bytes of one such patch */
    uint64_t tables_us;                   /* time to read, build and upload */
    double box_min[3], box_max[3];
    char warnings[4096]; /* lines of text; "": none */
    uint32_t n_findings; /* entries of `findings`, at most one of each kind */
    struct sheen_finding findings[SHEEN_MAX_FINDINGS];
    uint32_t patches; /* of a model of patches, which has no faces and vertices; else 0 */
};
#define SHEEN_MODEL_INFO_DEFAULTS                                                                  \
    ((struct sheen_model_info){.size = sizeof(struct sheen_model_info)})

/* Describes an uploaded model and its cost. Builds the model's tables if needed. SHEEN_BAD_ARGUMENT
 * while requests are in flight; SHEEN_UNKNOWN_MODEL if the daemon does not have the model. *info is
 * unchanged on failure. */
enum sheen_status sheen_query_model(struct sheen_session *session, const uint8_t id[SHEEN_ID_BYTES],
                                    const struct sheen_progress *progress,
                                    struct sheen_model_info *info, struct sheen_error *error);

static inline struct sheen_model_info sheen_model_info_defaults(void)
{
    struct sheen_model_info info;
    sheen_struct_init(&info, sizeof(info));
    return info;
}

SHEEN_DECLARATIONS_END

#endif
