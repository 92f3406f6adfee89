/* The sRGB transfer curve (IEC 61966-2-1), for one channel. Colours in requests and 8-bit pictures
 * are encoded with it; mixing is done in linear light. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_SRGB_H
#define SHEEN_PROTOCOL_SRGB_H

#include <math.h>

/* Converts an sRGB value in [0,1] to linear light in [0,1]. */
static inline double srgb_to_linear(double displayed)
{
    return displayed <= 0.04045 ? displayed / 12.92 : pow((displayed + 0.055) / 1.055, 2.4);
}

/* Converts linear light in [0,1] to an sRGB value in [0,1]. */
static inline double srgb_from_linear(double light)
{
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

#endif
