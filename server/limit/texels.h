/* Control points rounded to single precision, once, at the end of all double arithmetic. */
#ifndef SHEEN_LIMIT_TEXELS_H
#define SHEEN_LIMIT_TEXELS_H

#include <stddef.h>

#include "server/limit/vec.h"

/* Writes n + 1 texels: a power of two, then n points divided by it, so that the largest coordinate
 * comes to lie in [1/2, 1). Single precision then never under- or overflows in the products of
 * derivatives that the GPU forms. */
void texels_write(const struct vec *points, size_t n, float (*texels)[3]);

#endif
