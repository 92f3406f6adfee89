/* The sRGB curve (IEC 61966-2-1), written from the standard and not from protocol/srgb.h, so that
 * it judges that. */
#ifndef SHEEN_TESTS_ORACLE_SRGB_H
#define SHEEN_TESTS_ORACLE_SRGB_H

#include <cmath>

/* Linear light of a displayed value, both in [0,1]. */
inline double light_of(double displayed)
{
    if (displayed > 0.04045)
        return std::exp(2.4 * std::log((displayed + 0.055) / 1.055));
    return displayed / 12.92;
}

/* The displayed value of linear light, both in [0,1]. */
inline double displayed_of(double light)
{
    if (light > 0.0031308)
        return 1.055 * std::exp(std::log(light) / 2.4) - 0.055;
    return 12.92 * light;
}

#endif
