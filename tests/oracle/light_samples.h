/* Where many rays a pixel meet the light, unfiltered: from them every number of stripes can be
 * told. Drawn in this process, since pictures of that size are slow to send. */
#ifndef SHEEN_TESTS_ORACLE_LIGHT_SAMPLES_H
#define SHEEN_TESTS_ORACLE_LIGHT_SAMPLES_H

#include <cstdint>
#include <vector>

#include "tests/oracle/scene.h"

/* The middle of a frame. */
struct middle_part {
    int x0_px, y0_px, width_px, height_px;
};

class light_samples
{
  public:
    static const int side = 16, per_pixel = side * side;

    /* Samples the light of a request, over the middle part of its picture. */
    light_samples(drawing *drawing, const frame_request &request, const middle_part &part);

    ~light_samples();
    light_samples(const light_samples &) = delete;
    light_samples &operator=(const light_samples &) = delete;

    /* Of the part's pixel i: how many samples see nothing, and how many miss the light. */
    std::vector<uint16_t> n_empty, n_miss;
    /* How many see the bright part of so many stripes, duty 1/2. */
    std::vector<uint16_t> bright(double stripes) const;

  private:
    template <typename predicate> void count(std::vector<uint16_t> *n, predicate is_so) const;

    int width_px, height_px;
    struct frame frame; /* rows of samples; s and t are NaN where the light is not met */
};

#endif
