/* Samples where many rays of each pixel meet the light, without filtering; the result for every
 * number of stripes follows from them. Rendered in this process, because pictures of that size are
 * slow to send. */
#ifndef SHEEN_TESTS_ORACLE_LIGHT_SAMPLES_H
#define SHEEN_TESTS_ORACLE_LIGHT_SAMPLES_H

#include <cstdint>
#include <vector>

#include "tests/oracle/scene.h"

/* The middle part of a frame. */
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

    /* For pixel i of the part: the number of samples that see nothing, and the number that miss the
     * light. */
    std::vector<uint16_t> n_empty, n_miss;
    /* For each pixel, the number of samples that see the bright part of this many stripes, duty
     * 1/2. */
    std::vector<uint16_t> bright(double stripes) const;

  private:
    template <typename predicate> void count(std::vector<uint16_t> *n, predicate is_so) const;

    int width_px, height_px;
    struct frame frame; /* rows of samples; s and t are NaN where the ray misses the light */
};

#endif
