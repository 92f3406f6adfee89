#include "server/image/blend.h"

#include <math.h>

#include "protocol/srgb.h"

void blend(const float a[4], const float b[4], float share, float mean[4])
{
    double of_a = (double)share * (double)a[3], of_b = (1 - (double)share) * (double)b[3];
    double alpha = of_a + of_b;
    for (int k = 0; k < 3; k++) {
        double light = of_a * srgb_to_linear((double)a[k]) + of_b * srgb_to_linear((double)b[k]);
        mean[k] = alpha > 0 ? (float)srgb_from_linear(light / alpha) : 0;
    }
    mean[3] = (float)alpha;
}

void blend_pixel(uint8_t rgba[4], const float colour[4], float share)
{
    float pixel[4];
    for (int k = 0; k < 4; k++)
        pixel[k] = (float)rgba[k] / 255;
    blend(colour, pixel, share, pixel);
    blend_to_bytes(pixel, rgba);
}

void blend_to_bytes(const float colour[4], uint8_t rgba[4])
{
    for (int k = 0; k < 4; k++)
        rgba[k] = (uint8_t)(255 * fminf(1, fmaxf(0, colour[k])) + 0.5f);
}
