/* Means of colours as displayed (sRGB-encoded, straight alpha), taken of what they show: linear
 * light, premultiplied by alpha. Plain functions, any thread. */
#ifndef SHEEN_IMAGE_BLEND_H
#define SHEEN_IMAGE_BLEND_H

#include <stdint.h>

/* mean = share of a, the rest b; share in [0,1]. `mean` may be one of the two. */
void blend(const float a[4], const float b[4], float share, float mean[4]);

/* Blends `colour`, which covers `share` of the pixel, over a pixel of 8 bits. */
void blend_pixel(uint8_t rgba[4], const float colour[4], float share);

/* Clamped and rounded to 8 bits. */
void blend_to_bytes(const float colour[4], uint8_t rgba[4]);

#endif
