#include "protocol/ranges.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "protocol/limits.h"

#define LEAST_DIRECTION 1e-30
#define LEAST_SINE 1e-9
/* Squares of lengths on a light must stay normal numbers in single precision. */
#define LEAST_LENGTH 1e-18
#define GREATEST_LENGTH 1e18
#define GREATEST PROTOCOL_MAX_COORDINATE
#define TURNS 1e6

const struct range RANGES[N_RANGES] = {
    [RANGE_SIDE] = {"width_px, height_px", "--size", 1, PROTOCOL_MAX_SIZE_PX, false, "pixels"},
    [RANGE_JPEG_SIDE] = {"the same of a JPEG file", "--size", 1, PROTOCOL_MAX_JPEG_PX, false,
                         "pixels"},
    [RANGE_WINDOW_AT] = {"window.x_px, y_px", NULL, 0, PROTOCOL_MAX_SIZE_PX - 1, false, "pixels"},
    [RANGE_WINDOW_SIDE] = {"window.width_px, height_px", NULL, 1, PROTOCOL_MAX_SIZE_PX, false,
                           "pixels"},
    [RANGE_COORDINATE] = {"every coordinate", NULL, -GREATEST, GREATEST, false, ""},
    [RANGE_FOV] = {"camera.fov_deg", "--fov", 1e-6, 179, false, "degrees"},
    [RANGE_ORTHO_HEIGHT] = {"camera.ortho_height", "--ortho", 0, GREATEST, true, ""},
    [RANGE_ZOOM] = {"camera.zoom", "--zoom", 1, 1e6, false, ""},
    [RANGE_ZOOM_AT] = {"camera.zoom_x, zoom_y", "--zoom", 0, 1, false, ""},
    [RANGE_LIGHTS] = {"lights", "--light", 0, PROTOCOL_MAX_LIGHTS, false, ""},
    [RANGE_LIGHT_SIDE] = {"length of light.u, light.v", "--light-u, --light-v", LEAST_LENGTH,
                          GREATEST_LENGTH, false, "units"},
    [RANGE_PATTERN_COUNT] = {"pattern.count", "--pattern", 0, 100000, true, ""},
    [RANGE_PATTERN_PERIOD] = {"pattern.period", "--pattern", LEAST_LENGTH, GREATEST_LENGTH, false,
                              ""},
    [RANGE_PATTERN_DUTY] = {"pattern.duty", "--pattern", 0, 1, false, ""},
    [RANGE_PATTERN_ROTATION] = {"pattern.rotation_deg", "--pattern", -TURNS, TURNS, false,
                                "degrees"},
    [RANGE_PATTERN_OFFSET] = {"pattern.offset", "--pattern", -TURNS, TURNS, false, "periods"},
    [RANGE_PATTERN_SOFT] = {"pattern.soft", "--pattern", 0, 1, false, ""},
    [RANGE_PATTERN_OPACITY] = {"pattern.opacity", "--pattern", 0, 1, false, ""},
    [RANGE_PATTERN_LINES] = {"number of pattern.at", "--pattern", 1, PROTOCOL_MAX_LINES, false, ""},
    [RANGE_PATTERN_AT] = {"pattern.at", "--pattern", -TURNS, TURNS, false, ""},
    [RANGE_PATTERN_WIDTH] = {"pattern.width", "--pattern", 0, 1, true, ""},
    [RANGE_COLOUR] = {"r, g, b and a of colours", NULL, 0, 1, false, ""},
    [RANGE_SHOW_CURVATURE] = {"show.range", "--show-range", 0, GREATEST, true, ""},
    [RANGE_SHOW_DRAFT] = {"show.range of draft", "--show-range", 0, 90, true, "degrees"},
    [RANGE_JPEG_QUALITY] = {"jpeg_quality", "--jpeg-quality", 1, 100, false, ""},
    [RANGE_LEVEL] = {"surface_level", "--surface", 0, PROTOCOL_MAX_SURFACE_LEVEL, false, ""},
    [RANGE_DEADLINE] = {"deadline_ms", "--deadline", 1, 3600000, false, "milliseconds"},
    [RANGE_GAP] = {"gap", "--gap", 0, GREATEST, true, "units"},
    [RANGE_ANGLE] = {"angle_deg", "--angle", 0, 180, true, "degrees"},
    [RANGE_PERCENT] = {"curvature_percent", "--curvature", 0, 200, true, "percent"},
    [RANGE_COMPARE_DISTANCE] = {"distance", "--limit distance", 0, GREATEST, true, "units"},
    [RANGE_COMPARE_NORMAL] = {"normal_deg", "--limit normal_deg", 0, 180, true, "degrees"},
    [RANGE_COMPARE_LINES] = {"lines", "--limit lines", 0, 1e6, true, "spacings"},
    [RANGE_COMPARE_LENGTH] = {"line_length", "--limit line_length", 0, GREATEST, true, "units"},
    [RANGE_COMPARE_CURVATURE] = {"curvature", "--limit curvature", 0, 2, true, ""},
    [RANGE_COMPARE_SAMPLES] = {"samples", "--samples", 1000, 100000000, false, ""},
    [RANGE_TOLERANCE] = {"tolerance", "--tolerance", 0, GREATEST, true, "units"},
    [RANGE_LINE_PLACE] = {"at", "--at", -1e6, 1e6, false, ""},
};

bool range_holds(const struct range *range, double value)
{
    return (range->above_least ? value > range->least : value >= range->least) &&
           value <= range->greatest;
}

/* Writes a number in the usual form: 1e-6, not 1e-06. */
static void write_number(double value, char text[static 24])
{
    snprintf(text, 24, "%.7g", value);
    char *exponent = strchr(text, 'e');
    if (!exponent)
        return;
    char *to = exponent + 1, *from = to;
    if (*from == '-')
        to++;
    from += 1 + strspn(from + 1, "0");
    memmove(to, from, strlen(from) + 1);
}

const char *range_text(const struct range *range, char text[static RANGE_TEXT_BYTES])
{
    char least[24], greatest[24];
    write_number(range->least, least);
    write_number(range->greatest, greatest);
    snprintf(text, RANGE_TEXT_BYTES, "%s %s %s %s%s%s", range->above_least ? "above" : "from",
             least, range->above_least ? "and at most" : "to", greatest, *range->unit ? " " : "",
             range->unit);
    return text;
}

double range_length(const double v[3])
{
    return hypot(hypot(v[0], v[1]), v[2]);
}

static double largest_of(const double v[3])
{
    return fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
}

bool range_is_zero(const double v[3])
{
    return !(largest_of(v) >= LEAST_DIRECTION);
}

/* a x b|^2 <= sine^2 |a|^2 |b|^2. Both vectors are first scaled to about length 1, so that nothing
 * overflows. */
bool range_is_parallel(const double a[3], const double b[3])
{
    if (range_is_zero(a) || range_is_zero(b))
        return true;
    double p[3], q[3], cross = 0, size_p = 0, size_q = 0;
    for (int i = 0; i < 3; i++) {
        p[i] = a[i] / largest_of(a);
        q[i] = b[i] / largest_of(b);
        size_p += p[i] * p[i];
        size_q += q[i] * q[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double c = p[j] * q[k] - p[k] * q[j];
        cross += c * c;
    }
    return cross <= LEAST_SINE * LEAST_SINE * size_p * size_q;
}
