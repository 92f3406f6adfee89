/* What the files of the comparison share. Private to them. */
#ifndef SHEEN_CURVES_COMPARE_PARTS_H
#define SHEEN_CURVES_COMPARE_PARTS_H

#include "server/curves/compare/align.h"
#include "server/curves/compare/closest.h"
#include "server/curves/compare/comparison.h"
#include "server/curves/compare/samples.h"

/* The worst samples that are refined for each measure, one of each leaf; and how many of them a slice keeps. */
enum { WORST = 32, WORST_OF_SLICE = 8 };

/* Samples of leaves that tell how the new surface is wound as a whole. */
enum { WINDING_SAMPLES = 512 };

/* A place of a leaf on one side, and the values there. NAN: not defined. */
struct comparison_values {
    struct limit_point from;
    struct closest to;
    bool is_covered, is_rewound, is_unlit;
    double value[COMPARISON_MEASURES];
};

struct worst_sample {
    double magnitude; /* -1: none */
    double value;
    size_t leaf;
    double x, y, step; /* step: half the distance of samples */
    struct closest_start to;
};

/* What one slice of samples adds up to. */
struct sample_sums {
    double area, uncovered, rewound, unlit, largest_uncovered;
    struct comparison_place uncovered_at;
    double weight[COMPARISON_MEASURES], square[COMPARISON_MEASURES], out[COMPARISON_MEASURES];
    struct worst_sample worst[COMPARISON_MEASURES][WORST_OF_SLICE];
};

/* How far one slice of samples has come. */
struct sample_progress {
    bool is_begun, is_in_leaf, is_done;
    size_t leaf, index;    /* of the next sample */
    unsigned part, sample; /* of the leaf's parts, and of the part's samples: the next one */
    double before;         /* the area before the leaf's last level */
    struct worst_sample worst[COMPARISON_MEASURES]; /* of this leaf */
    struct closest_start last;                      /* counterpart of the sample before */
};

/* How far the refinement of one of the worst samples has come. */
struct refine_progress {
    bool is_begun;
    double margin[2], step;
    int halved, tries;
};

/* One side: its samples, which look at the other side. */
struct comparison_part {
    struct kept_surface surface;
    struct surface_tree tree;
    struct surface_samples samples;
    float *weights;                     /* [samples] */
    float *values[COMPARISON_MEASURES]; /* [samples]; NULL: not asked for */
    size_t *slice_first;                /* [n_slices + 1]: first leaf of each slice of samples */
    size_t n_slices;
    struct sample_sums *sums;         /* [n_slices] */
    struct sample_progress *progress; /* [n_slices] */
    struct worst_sample worst[COMPARISON_MEASURES][WORST];
    struct refine_progress refined[COMPARISON_MEASURES][WORST];
};

struct comparison {
    struct computation base;
    unsigned phase;                       /* that begin() has prepared */
    bool is_repeat;                       /* the phase was begun before */
    signed char winding[WINDING_SAMPLES]; /* of each sample: 1 the same, -1 reversed, 0 unknown */
    size_t *open; /* the slices of samples that are not done; those of the new side come after */
    size_t n_open;
    struct comparison_setup setup;
    struct comparison_part part[COMPARISON_SIDES];
    struct closest_rules rules;
    struct alignment alignment;
    struct comparison_result result;
};

/* The values at local (x,y) of a leaf of a side (comparison_values.c). */
void comparison_measure_at(const struct comparison *comparison, enum comparison_side side,
                           size_t leaf, double x, double y, const struct closest_start *start,
                           struct comparison_values *out);
/* The place of a side's own point, and of its counterpart. */
struct comparison_place comparison_place_of(const struct kept_surface *surface, size_t leaf,
                                            double x, double y, struct vec position);

/* Samples of one slice (comparison_samples.c). */
void comparison_sample(struct comparison *comparison, enum comparison_side side, size_t slice);
/* Lists the worst samples of a side, when all its slices have run. */
void comparison_choose_worst(struct comparison *comparison, enum comparison_side side);
/* Moves a sample to a local maximum of its measure (comparison_refine.c). */
void comparison_refine(struct comparison *comparison, enum comparison_side side,
                       enum comparison_measure measure, size_t i);
/* Computes the figures of a measure of a side from its samples (comparison_figures.c). */
void comparison_compute_figures(struct comparison *comparison, enum comparison_side side,
                                enum comparison_measure measure);
void comparison_sum_side(struct comparison *comparison, enum comparison_side side);

#endif
