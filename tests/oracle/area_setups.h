/* Random views, lights and patterns, for tests of colours that are averages over pixels. */
#ifndef SHEEN_TESTS_ORACLE_AREA_SETUPS_H
#define SHEEN_TESTS_ORACLE_AREA_SETUPS_H

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/oracle/lines.h"
#include "tests/oracle/view.h"

/* A generator of random numbers that gives the same numbers with every C++ library. */
class chance
{
  public:
    explicit chance(uint32_t seed) : engine(seed)
    {
    }
    double between(double low, double high)
    {
        return low + (high - low) * ((double)engine() / 4294967296.0);
    }
    int below(int n)
    {
        return (int)between(0, n);
    }
    bool with(double probability)
    {
        return between(0, 1) < probability;
    }
    /* A number whose logarithm is uniform. */
    double scaled(double low, double high)
    {
        return low * std::pow(high / low, between(0, 1));
    }
    vec3 direction();

  private:
    std::mt19937 engine;
};

struct area_setup {
    view camera;
    line_setup lines;
    rgba empty;

    std::vector<std::string> options() const; /* of `sheen render` */
};

/* Makes a file with a picture of patches and single texels, some of them transparent. */
std::shared_ptr<const line_image> make_image(chance *chance, const std::string &path, bool opaque);

/* Makes a setup. Its number chooses the kinds of its first light and pattern, so that all occur
 * equally often. The box is the model's. */
area_setup make_area_setup(chance *chance, int number, vec3 box_min, vec3 box_max,
                           std::shared_ptr<const line_image> image, int width_px, int height_px);

#endif
