/* Random setups around a model: cameras, line eyes and lights from near to 10^4 model sizes away,
 * wide, thin and fine, with u not perpendicular to v. The same seed gives the same setups. */
#ifndef SHEEN_TESTS_ORACLE_RANDOM_SETUPS_H
#define SHEEN_TESTS_ORACLE_RANDOM_SETUPS_H

#include <random>

#include "tests/oracle/lines.h"
#include "tests/oracle/view.h"

struct seen_setup {
    view camera;
    line_setup setup; /* with one light; its pattern is unchanged */
};

class random_setups
{
  public:
    /* `size`: the diagonal of the model's box. */
    random_setups(vec3 middle, double size, int width_px, int height_px, unsigned seed);
    seen_setup choose(line_family family, line_light_kind kind);
    /* A tunnel six model sizes above the model, with a radius of a sixteenth of a model size:
     * differences of squared lengths there lose all digits that distinguish lines. */
    seen_setup choose_thin_tunnel();

  private:
    std::mt19937 random;
    const vec3 middle;
    const double size;
    const int width_px, height_px;

    double uniform(double low, double high);
    bool chance(double share);
    /* A length from 10^low to 10^high model sizes. */
    double sizes(double low, double high);
    vec3 direction();
    /* A direction at least 6 degrees away from the axis. */
    vec3 direction_off(vec3 axis);
    view choose_camera();
    void choose_eye(line_setup *setup);
    line_light choose_light(line_light_kind kind);
    void choose_flat(line_light *light, double distance, vec3 to_light);
    void choose_tunnel(line_light *light, double distance, vec3 to_light);
};

#endif
