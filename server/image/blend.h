/* Blends colours that are sRGB-encoded with straight alpha. Blending is done on linear light,
 * premultiplied by alpha. Pure, any thread. */
#ifndef SHEEN_IMAGE_BLEND_H
#define SHEEN_IMAGE_BLEND_H

#include <stdint.h>

/* mean = share * a + (1 - share) * b; share in [0,1]. `mean` may be `a` or `b`. */
void blend(const float a[4], const float b[4], float share, float mean[4]);

/* Blends `colour`, which covers `share` of the pixel, over an 8-bit pixel. */
void blend_pixel(uint8_t rgba[4], const float colour[4], float share);

/* Converts to 8 bits, clamped and rounded. */
void blend_to_bytes(const float colour[4], uint8_t rgba[4]);

#endif
