/* The sRGB curve (IEC 61966-2-1), by channel: colours in requests and 8-bit pictures are encoded
 * with it, and are mixed as linear light. Any thread. */
#ifndef SHEEN_PROTOCOL_SRGB_H
#define SHEEN_PROTOCOL_SRGB_H

#include <math.h>

/* From a displayed value in [0,1] to linear light in [0,1]. */
static inline double srgb_to_linear(double displayed)
{
    return displayed <= 0.04045 ? displayed / 12.92 : pow((displayed + 0.055) / 1.055, 2.4);
}

/* And back. */
static inline double srgb_from_linear(double light)
{
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

#endif
