/* The table of ranges of a request's numbers. Client, protocol and renderer check by this table,
 * --help prints it, and README.md lists it for people. Constant data and pure functions, any
 * thread. */
#ifndef SHEEN_PROTOCOL_RANGES_H
#define SHEEN_PROTOCOL_RANGES_H

#include <stdbool.h>
#include <stddef.h>

enum range_name {
    RANGE_SIDE,      /* the device's limit may be lower */
    RANGE_JPEG_SIDE, /* libjpeg's limit */
    RANGE_WINDOW_AT,
    RANGE_WINDOW_SIDE,
    RANGE_COORDINATE,
    RANGE_FOV,
    RANGE_ORTHO_HEIGHT,
    RANGE_ZOOM,
    RANGE_ZOOM_AT,
    RANGE_LIGHTS,
    RANGE_LIGHT_SIDE, /* length of a light's u and of its v */
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
    RANGE_SHOW_CURVATURE, /* show.range for curvatures */
    RANGE_SHOW_DRAFT,     /* show.range for draft */
    RANGE_JPEG_QUALITY,   /* libjpeg's scale */
    RANGE_LEVEL,
    RANGE_DEADLINE,
    RANGE_GAP,
    RANGE_ANGLE,
    RANGE_PERCENT,
    RANGE_COMPARE_DISTANCE,
    RANGE_COMPARE_NORMAL,
    RANGE_COMPARE_LINES,
    RANGE_COMPARE_LENGTH,
    RANGE_COMPARE_CURVATURE,
    RANGE_COMPARE_SAMPLES,
    RANGE_TOLERANCE,
    RANGE_LINE_PLACE,
    N_RANGES
};

struct range {
    /* Name in error texts and in README.md, usually the field of sheen.proto; NULL: only an option
     * of the command line. */
    const char *field;
    const char *option; /* option of the command line; NULL: none */
    double least, greatest;
    bool above_least; /* `least` itself is not allowed */
    const char *unit; /* unit, written behind the numbers; "": none */
};
extern const struct range RANGES[N_RANGES];

/* True if `value` is in range; false for NaN. */
bool range_holds(const struct range *range, double value);

/* Writes the range as text, such as "from 1e-6 to 179 degrees" or "above 0 and at most 100000".
 * Returns `text`. */
#define RANGE_TEXT_BYTES 80
const char *range_text(const struct range *range, char text[static RANGE_TEXT_BYTES]);

/* True if v is too short to be a direction: every coordinate is below 1e-30 in magnitude. (Squares
 * of larger coordinates do not become 0.) */
bool range_is_zero(const double v[3]);
/* The Euclidean length of v, for RANGE_LIGHT_SIDE. */
double range_length(const double v[3]);
/* True if the sine of the angle between a and b is at most 1e-9, or if one of them is zero. */
bool range_is_parallel(const double a[3], const double b[3]);

#endif
