/* Computes what each pixel of a frame shows from many samples: places on the surface come from the
 * exact positions and normals of an enlarged frame; the colours there are computed by lines.h, in
 * double precision. */
#ifndef SHEEN_TESTS_ORACLE_AREA_SAMPLES_H
#define SHEEN_TESTS_ORACLE_AREA_SAMPLES_H

#include <vector>

#include "tests/oracle/area_setups.h"
#include "tests/oracle/surface_grid.h"

struct area_sample {
    rgba light;      /* the mean, linear, premultiplied */
    double coverage; /* share of the samples that meet the surface */
    double step;     /* largest change of a pattern from one sample to the next, in its periods */
    bool at_edge;    /* some samples miss the surface, or meet different sheets or sides */
    unsigned met;    /* lights that some sample meets, as bits */
    unsigned partly; /* lights that some sample meets and another does not */
};

const int area_samples_side = 20; /* samples of a pixel in each direction */

/* Samples every pixel of the setup, top row first. The grid has area_samples_side x
 * area_samples_side rays for each pixel. */
std::vector<area_sample> sample_areas(const surface_grid &grid, const area_setup &setup);

#endif
