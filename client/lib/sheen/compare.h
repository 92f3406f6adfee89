/* Computed numbers: how far two surfaces differ. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_COMPARE_H
#define SHEEN_PUBLIC_COMPARE_H

#include "base.h"
#include "request.h"
#include "scene.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

/* What is compared at each sample; server/curves/README.md defines all measures. */
enum sheen_compare_measure {
    SHEEN_COMPARE_DISTANCE,    /* units; positive where the new surface is outside of the old one */
    SHEEN_COMPARE_NORMAL,      /* between the normals, up to winding, degrees */
    SHEEN_COMPARE_LINES,       /* shift of a light's lines, spacings */
    SHEEN_COMPARE_LINE_LENGTH, /* the same as a length on the surface, units */
    SHEEN_COMPARE_CURVATURE,   /* change of the larger principal curvature, as a share of it */
};
#define SHEEN_N_COMPARE_MEASURES 5

struct sheen_compare_options {
    size_t size;
    uint8_t new_id[SHEEN_ID_BYTES]; /* the model that is compared with the request's */
    /* An area where a measure exceeds its limit is out of tolerance. 0 takes the default. Distance:
     * 1e-5 of the diagonal of the old model's box, above 0 to 1e30. Normal: 0.05, above 0 to 180.
     * Lines: 0.1, above 0 to 1e6. Line length: no limit, above 0 to 1e30. Curvature: not compared,
     * above 0 to 2. */
    double limits[SHEEN_N_COMPARE_MEASURES];
    bool align; /* move the new surface onto the old one first */
    /* Number of samples of both surfaces together, approximately: 1000 to 100000000, or more if
     * there are more patches; 0: a million. */
    uint32_t samples;
};
#define SHEEN_COMPARE_OPTIONS_DEFAULTS                                                             \
    ((struct sheen_compare_options){.size = sizeof(struct sheen_compare_options)})

struct sheen_compared_place {
    uint32_t face; /* Ptex face */
    double uv[2], position[3];
};

/* A measure over the samples of one surface. */
struct sheen_compared_measure {
    bool is_known;                     /* false: it has no value anywhere, or was not asked for */
    double worst;                      /* the value whose magnitude is largest */
    struct sheen_compared_place at[2]; /* where: on the old and on the new surface */
    double rms, p95, p99;              /* over the area */
    double area_out;                   /* beyond the limit, square units */
};

/* What the samples of one surface found on the other one. Areas are in square units. */
struct sheen_compared_side {
    uint64_t samples;
    double area;
    double area_uncovered; /* where the other surface is missing */
    double area_rewound;   /* whose counterpart is wound the other way around */
    double area_unlit;     /* where a light is met on one surface only */
    bool has_uncovered;    /* `uncovered` is a place where the other surface is missing */
    struct sheen_compared_place uncovered;
    struct sheen_compared_measure measures[SHEEN_N_COMPARE_MEASURES];
};

/* Initialise it with SHEEN_COMPARISON_DEFAULTS. It owns no memory. */
struct sheen_comparison {
    size_t size;
    struct sheen_compared_side sides[2]; /* the old surface's samples, and the new one's */
    bool is_rewound; /* the new surface as a whole is wound the other way around */
    bool is_aligned;
    /* With is_aligned: in how many independent directions (of 6, shifts and rotations) the new
     * surface slides along itself, as a plane does in 3. The new surface was not moved in these
     * directions. */
    uint32_t free_directions;
    double diagonal; /* of the old model's box, units */
    /* Differences up to these values (units; degrees) occur between equal surfaces from different
     * files, because of rounding. */
    double distance_floor, normal_floor_deg;
    double limits[SHEEN_N_COMPARE_MEASURES]; /* that were used; INFINITY: none */
    /* With is_aligned: the motion of the new surface, a rotation row by row and then a shift in
     * units; the rotation's angle; and the root mean square of the distances before and after, in
     * units. */
    double rotation[9], shift[3], rotation_deg, rms_before, rms_after;
    /* The camera, lines and lights that were used. */
    struct sheen_camera camera;
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    uint64_t total_us; /* from the request's last byte to the answer's first */
    char server[32];   /* the daemon's version */
};
#define SHEEN_COMPARISON_DEFAULTS                                                                  \
    ((struct sheen_comparison){.size = sizeof(struct sheen_comparison)})

/* Compares request's model, the old one, with options->new_id, in double precision on the surfaces
 * themselves. Of the request, model, camera, lines, lights and deadline_ms count; the image of an
 * image pattern need not be uploaded. protocol/README.md, chapter 10. SHEEN_BAD_ARGUMENT while
 * requests are in flight, or with a daemon that is too old. `options` must not be NULL; `progress`
 * may be NULL. On failure *comparison is unchanged. */
enum sheen_status sheen_compare(struct sheen_session *session, const struct sheen_request *request,
                                const struct sheen_compare_options *options,
                                const struct sheen_progress *progress,
                                struct sheen_comparison *comparison, struct sheen_error *error);

static inline struct sheen_compare_options sheen_compare_options_defaults(void)
{
    struct sheen_compare_options options;
    sheen_struct_init(&options, sizeof(options));
    return options;
}

static inline struct sheen_comparison sheen_comparison_defaults(void)
{
    struct sheen_comparison comparison;
    sheen_struct_init(&comparison, sizeof(comparison));
    return comparison;
}

SHEEN_DECLARATIONS_END

#endif
