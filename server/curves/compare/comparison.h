/* Compares two surfaces: for samples of each, how far the other one is along the normal, how its normal, its lines and
 * its curvature differ, and where it is missing. README.md defines the measures.
 *
 * A struct computation (computation.h). comparison_read() gives the result after computation_run(). */
#ifndef SHEEN_CURVES_COMPARE_COMPARISON_H
#define SHEEN_CURVES_COMPARE_COMPARISON_H

#include "server/curves/computation.h"
#include "server/curves/compare/kept_surface.h"
#include "server/curves/line_position.h"

enum comparison_measure {
    COMPARISON_DISTANCE,    /* model's unit, positive on the side of the old surface's normal */
    COMPARISON_NORMAL,      /* degrees, up to winding */
    COMPARISON_LINES,       /* spacings: how far lines move on the light */
    COMPARISON_LINE_LENGTH, /* model's unit: how far lines move on the surface */
    COMPARISON_CURVATURE,   /* change of the larger principal curvature, as a share of it */
    COMPARISON_MEASURES,
};

/* Old and new, in this order, in arrays of two. */
enum comparison_side { COMPARISON_OLD, COMPARISON_NEW, COMPARISON_SIDES };

struct comparison_setup {
    const struct limit_tables *tables[COMPARISON_SIDES]; /* outlive the computation */
    struct line_map lights[MAX_LIGHTS];
    uint32_t n_lights; /* 0: lines are not compared */
    bool has_curvature;
    bool is_aligned; /* first moves the new surface onto the old one (align.h) */
    /* What counts as out of tolerance; INFINITY: nothing. The limit of the distance is finite and above 0: what lies
     * closer to a border than it is not missing. */
    double limit[COMPARISON_MEASURES];
    size_t n_samples;  /* of both sides together, about */
    size_t most_bytes; /* of memory */
    /* A slice of samples returns after this time, in microseconds, and goes on when its phase is repeated; 0: 20 ms. The
     * result does not depend on it. */
    uint64_t task_us;
};

struct comparison_place {
    uint32_t face;
    double u, v;
    struct vec position;
};

struct comparison_figures {
    bool is_known; /* false: no sample has this measure */
    double worst;  /* the value whose magnitude is largest, refined to a local maximum */
    struct comparison_place at[COMPARISON_SIDES];
    double rms, p95, p99; /* over the area */
    double area_out;      /* beyond the limit */
};

/* What the samples of one side found on the other side. Areas are in the model's unit, squared. */
struct comparison_result_side {
    size_t n_samples;
    double area;
    double area_uncovered; /* without a counterpart */
    double area_rewound;   /* whose counterpart is wound the other way around */
    double area_unlit;     /* where a light is met on one side only */
    struct comparison_place
        uncovered_at; /* a place of the largest uncovered sample, if there is any */
    struct comparison_figures figures[COMPARISON_MEASURES];
};

struct comparison_result {
    struct comparison_result_side side[COMPARISON_SIDES];
    bool is_rewound; /* the new surface as a whole is wound the other way around */
    double size;     /* diagonal of the old surface's box */
    /* Rounding of the tables' points to single precision: what distances and normals of equal surfaces may differ by
     * when their files differ. */
    double distance_floor, normal_floor_deg;
    /* With is_aligned: the motion of the new surface; the angle of its rotation, degrees; the root mean square of the
     * distances before and after it; the number of directions in which the new surface slides along itself. */
    struct rigid_motion motion;
    double rotation_deg, rms_before, rms_after;
    unsigned free_directions;
};

/* An upper bound of the memory that a comparison of these surfaces by n_samples needs; more pieces of a surface than
 * these bytes have room for are refused while it runs. */
size_t comparison_bytes(const struct limit_tables *const tables[COMPARISON_SIDES],
                        size_t n_samples);

/* NULL with ERROR_SERVER (no memory) or ERROR_MODEL (a side has no surface). */
struct computation *comparison_create(const struct comparison_setup *setup, struct error *error);
/* The result, which the computation owns. */
const struct comparison_result *comparison_read(const struct computation *computation);

#endif
