/* The ranges of a request's numbers, each in one place: client, protocol and renderer check by this
 * table, --help prints it, and README.md repeats it for people.
 *
 * Constant data and pure functions, any thread. */
#ifndef SHEEN_PROTOCOL_RANGES_H
#define SHEEN_PROTOCOL_RANGES_H

#include <stdbool.h>
#include <stddef.h>

enum range_name {
    RANGE_SIDE,      /* a device's own limit is lower */
    RANGE_JPEG_SIDE, /* libjpeg's limit */
    RANGE_COORDINATE,
    RANGE_FOV,
    RANGE_ORTHO_HEIGHT,
    RANGE_ZOOM,
    RANGE_ZOOM_AT,
    RANGE_LIGHTS,
    RANGE_LIGHT_SIDE, /* length of a light's u and v */
    RANGE_PATTERN_COUNT,
    RANGE_PATTERN_PERIOD,
    RANGE_PATTERN_DUTY,
    RANGE_PATTERN_ROTATION,
    RANGE_PATTERN_OFFSET,
    RANGE_PATTERN_SOFT,
    RANGE_PATTERN_OPACITY,
    RANGE_PATTERN_LINES,
    RANGE_PATTERN_AT,
    RANGE_PATTERN_WIDTH,
    RANGE_COLOUR,
    RANGE_SHOW_CURVATURE, /* show.range of the curvatures */
    RANGE_SHOW_DRAFT,     /* show.range of draft */
    RANGE_JPEG_QUALITY,   /* as libjpeg has it */
    RANGE_LEVEL,
    RANGE_DEADLINE,
    N_RANGES
};

struct range {
    const char *field;  /* what error texts and README.md call it, mostly the field of sheen.proto;
                           NULL: a number of the command line alone */
    const char *option; /* of the command line; NULL: none */
    double least, greatest;
    bool above_least; /* `least` itself is out of range */
    const char *unit; /* what follows the numbers; "" where there is nothing to say */
};
extern const struct range RANGES[N_RANGES];

/* False for NaN. */
bool range_holds(const struct range *range, double value);

/* Writes "from 1e-6 to 179 degrees" or "above 0 and at most 100000"; returns `text`. */
#define RANGE_TEXT_BYTES 80
const char *range_text(const struct range *range, char text[static RANGE_TEXT_BYTES]);

/* Whether v is too short to be a direction: every coordinate is smaller than 1e-30 in magnitude.
 * Squares of larger ones do not vanish. */
bool range_is_zero(const double v[3]);
/* The Euclidean length of v, for RANGE_LIGHT_SIDE. */
double range_length(const double v[3]);
/* Whether the sine of the angle between a and b is 1e-9 at most, or one of them is zero. */
bool range_is_parallel(const double a[3], const double b[3]);

#endif
