/* Parses values of command-line options, strictly: the whole text must be a value, numbers must be
 * finite and within the ranges of protocol/ranges.h.
 *
 * Every parsing function returns false for other text, and then leaves *value undefined. Pure, any
 * thread. */
#ifndef SHEEN_CLIENT_VALUES_H
#define SHEEN_CLIENT_VALUES_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"

bool value_double(const char *text, double *value);              /* 1, -0.5, 1e3 */
bool value_numbers(const char *text, double *value, unsigned n); /* n numbers and commas between */
bool value_uint32(const char *text, uint32_t *value);            /* decimal digits */
bool value_vec3(const char *text, double value[static 3]);       /* X,Y,Z: coordinates */
/* X,Y,Z that is not zero; or x, y or z, with an optional sign. */
#define VALUE_DIRECTION_WORDS "x, y, z, -x, -y, -z, or X,Y,Z in numbers, not 0,0,0"
bool value_direction(const char *text, double value[static 3]);
/* Chooses the noun for a number: `one` or `many`. */
const char *value_noun(uint64_t number, const char *one, const char *many);
bool value_size(const char *text, uint32_t *width, uint32_t *height); /* 1280x720 */
bool value_colour(const char *text, float value[static 4]);           /* #rrggbb or #rrggbbaa */
bool value_planes(const char *text, uint32_t *planes); /* P,N,ptex,light,k,dlight,coverage */
/* The name of a plane other than colour (one bit); NULL for any other value. */
const char *value_plane_name(uint32_t plane);

/* exact, polygon:LEVEL or wireframe:LEVEL. */
bool value_surface(const char *text, enum sheen_surface *surface, uint32_t *level);

/* The format of a file by its ending, in any case: .png .exr .jpg .jpeg .tif .tiff. */
bool value_format(const char *path, enum sheen_format *format);

/* 444, 422 or 420. */
bool value_subsampling(const char *text, enum sheen_jpeg_subsampling *subsampling);
const char *value_subsampling_name(enum sheen_jpeg_subsampling subsampling);

/* interactive, still or batch. */
bool value_class(const char *text, enum sheen_class *request_class);
const char *value_class_name(enum sheen_class request_class);

/* front, back, left, right, top, bottom or iso; value_view_name() returns NULL for
 * SHEEN_VIEW_AROUND. */
bool value_view(const char *text, enum sheen_view *view);
const char *value_view_name(enum sheen_view view);

/* FACTOR or FACTOR@X,Y; without a place, the middle. */
bool value_zoom(const char *text, double *factor, double at[static 2]);

#endif
