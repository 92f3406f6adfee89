/* What each pixel of a frame shows by many samples of it: where the surface is met comes from an
 * enlarged frame's exact positions and normals, what is seen there from lines.h, in double. */
#ifndef SHEEN_TESTS_ORACLE_AREA_SAMPLES_H
#define SHEEN_TESTS_ORACLE_AREA_SAMPLES_H

#include <vector>

#include "tests/oracle/area_setups.h"
#include "tests/oracle/surface_grid.h"

struct area_sample {
    rgba light;      /* the mean, linear, premultiplied */
    double coverage; /* share of the samples that meet the surface */
    double step;  /* the most that a pattern changes from one sample to the next: in its periods */
    bool at_edge; /* some samples miss the surface, or meet sheets or sides apart */
    unsigned met; /* lights that some sample meets, as bits */
    unsigned partly; /* lights that some sample meets and another does not */
};

const int area_samples_side = 20; /* a pixel, each way */

/* Of every pixel of the setup, rows top first; the grid has so many rays of each. */
std::vector<area_sample> sample_areas(const surface_grid &grid, const area_setup &setup);

#endif
