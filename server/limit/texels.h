/* Control points rounded to single precision, once, at the end of all double arithmetic. */
#ifndef SHEEN_LIMIT_TEXELS_H
#define SHEEN_LIMIT_TEXELS_H

#include <stddef.h>

#include "server/limit/vec.h"

/* Writes n points divided by the power of two that brings the largest coordinate into [1/2, 1);
 * that power is the w of every texel. Single precision then never under- or overflows in the
 * products of derivatives that the GPU forms, and no fetch is spent on the scale alone. */
void texels_write(const struct vec *points, size_t n, float (*texels)[4]);

#endif
