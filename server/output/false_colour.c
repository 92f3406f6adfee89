#include "server/output/false_colour.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/image/blend.h"
#include "server/output/legend.h"

#define NO_FACE 0xffffffffu
#define DEFAULT_DRAFT_DEG 3
/* a smaller turn of the normal over the whole model is taken for rounding */
#define LEAST_TURN_RAD 1e-5
#define ROUNDING 1e-6     /* of single precision, relative */
#define SHARE_INSIDE 0.98 /* of the values lie inside a range that is chosen from the frame */

static const double DEG_PER_RAD = 57.295779513082320877;

struct ptex {
    uint32_t face;
    float u, v;
};

/* A picture being painted. Planes that its kind does not need are NULL. */
struct painting {
    sheen_ShowKind kind;
    size_t width_px, n_pixels;
    const float *coverage; /* NULL: one sample a pixel */
    const float (*position)[3], (*normal)[3], (*curvature)[2];
    const struct ptex *ptex;
    double pull[3]; /* DRAFT: unit */
    double range;
};

/* --- values */

static double draft_deg(const float n[3], const double pull[3])
{
    double along = 0, across = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        along += (double)n[i] * pull[i];
        across = hypot(across, (double)n[j] * pull[k] - (double)n[k] * pull[j]);
    }
    return atan2(along, across) * DEG_PER_RAD;
}

/* The value that a scale shows at a pixel; NaN or infinite: no value. */
static double value_at(const struct painting *painting, size_t i)
{
    if (painting->kind == sheen_ShowKind_SHOW_DRAFT)
        return draft_deg(painting->normal[i], painting->pull);
    double low = (double)painting->curvature[i][0], high = (double)painting->curvature[i][1];
    switch (painting->kind) {
    case sheen_ShowKind_SHOW_GAUSSIAN:
        return low * high;
    case sheen_ShowKind_SHOW_MEAN:
        return 0.5 * (low + high);
    default: /* the principal curvature of larger magnitude */
        return fabs(low) > fabs(high) ? low : high;
    }
}

/* The bits of |value|. Magnitudes have the same order as their bits read as integers. */
static uint64_t bits_of(double value)
{
    double magnitude = fabs(value);
    uint64_t bits;
    memcpy(&bits, &magnitude, sizeof bits);
    return bits;
}

enum { DIGIT_BITS = 16 };

/* Counts the finite values whose leading bits are `prefix`: returns how many there are, and in
 * `counts` how many have each value of the next DIGIT_BITS bits, which end at bit `shift`. */
static uint64_t count_digits(const struct painting *painting, uint64_t prefix, int shift,
                             uint32_t counts[static 1 << DIGIT_BITS])
{
    uint64_t n = 0;
    memset(counts, 0, sizeof *counts << DIGIT_BITS);
    for (size_t i = 0; i < painting->n_pixels; i++) {
        double value = value_at(painting, i);
        uint64_t bits = bits_of(value);
        if (!isfinite(value) || (shift + DIGIT_BITS < 64 && bits >> (shift + DIGIT_BITS) != prefix))
            continue;
        counts[bits >> shift & ((1u << DIGIT_BITS) - 1)]++;
        n++;
    }
    return n;
}

/* The magnitude that `share` (0 to 1) of all values do not exceed. It is exact and needs no memory
 * for the values: a radix selection, digit by digit, with one pass over the frame for each digit. 0
 * when there is no value. */
static double percentile(const struct painting *painting, double share)
{
    uint32_t counts[1 << DIGIT_BITS];
    uint64_t found = 0, rank = 0;
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        uint64_t n = count_digits(painting, found, shift, counts);
        if (n == 0)
            return 0;
        if (shift == 64 - DIGIT_BITS)
            rank = (uint64_t)ceil(share * (double)n);
        uint32_t digit = 0;
        for (; rank > counts[digit]; digit++)
            rank -= counts[digit];
        found = found << DIGIT_BITS | digit;
    }
    double magnitude;
    memcpy(&magnitude, &found, sizeof magnitude);
    return magnitude;
}

/* Rounds up to two significant digits, as exactly as a double can hold them. */
static double round_up(double value)
{
    int exponent = (int)floor(log10(value)) - 1;
    double unit = pow(10, abs(exponent));
    double digits = ceil((exponent < 0 ? value * unit : value / unit) * (1 - ROUNDING));
    return exponent < 0 ? digits / unit : digits * unit;
}

/* A difference between two values that is no larger than this may come from rounding. */
static double least_difference(const struct painting *painting, double size)
{
    if (painting->kind == sheen_ShowKind_SHOW_DRAFT)
        return LEAST_TURN_RAD * DEG_PER_RAD;
    double least = LEAST_TURN_RAD / fmax(size, 1 / PROTOCOL_MAX_COORDINATE);
    return painting->kind == sheen_ShowKind_SHOW_GAUSSIAN ? least * least : least;
}

static double range_of(const struct painting *painting, double size)
{
    if (painting->kind == sheen_ShowKind_SHOW_DRAFT)
        return DEFAULT_DRAFT_DEG;
    double value = fmax(least_difference(painting, size), percentile(painting, SHARE_INSIDE));
    return fmin(round_up(value), PROTOCOL_MAX_COORDINATE);
}

/* --- colours */

static void mix(const float a[3], const float b[3], double share, float rgb[3])
{
    for (int k = 0; k < 3; k++)
        rgb[k] = a[k] + (float)share * (b[k] - a[k]);
}

/* Moreland, Diverging color maps for scientific visualization (2009): perceived differences are
 * proportional to differences of the value, so that no bands appear that are not in the values. t
 * from 0 to 1. */
static void diverging(double t, float rgb[3])
{
    enum { STEPS = 8 };
    static const uint8_t table[STEPS + 1][3] = {
        {59, 76, 192},   {98, 130, 234},  {141, 176, 254}, {184, 208, 249}, {221, 221, 221},
        {245, 196, 173}, {244, 154, 123}, {222, 96, 77},   {180, 4, 38},
    };
    int i = (int)fmin(STEPS - 1, fmax(0, floor(t * STEPS)));
    float a[3], b[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (float)table[i][k] / 255;
        b[k] = (float)table[i + 1][k] / 255;
    }
    mix(a, b, fmin(1, fmax(0, t * STEPS - i)), rgb);
}

static void draft_colour(double deg, double range, float rgb[3])
{
    static const float yellow[3] = {1, 0.88f, 0.25f}, amber[3] = {0.93f, 0.68f, 0.1f};
    static const float ends[2][2][3] = {{{0.94f, 0.45f, 0.38f}, {0.5f, 0, 0.05f}},
                                        {{0.5f, 0.82f, 0.45f}, {0, 0.33f, 0.15f}}};
    if (fabs(deg) < range)
        memcpy(rgb, deg < 0 ? amber : yellow, sizeof yellow);
    else
        mix(ends[deg > 0][0], ends[deg > 0][1], (fabs(deg) - range) / fmax(90 - range, 1e-9), rgb);
}

static void scale_colour(const struct painting *painting, double value, float rgb[3])
{
    if (painting->kind == sheen_ShowKind_SHOW_DRAFT)
        draft_colour(value, painting->range, rgb);
    else
        diverging(0.5 + 0.5 * value / painting->range, rgb);
}

/* Faces with consecutive numbers get hues that lie far apart. */
static void ptex_colour(const struct ptex *ptex, float rgb[3])
{
    double hue = 6 * fmod(ptex->face * 0.61803398874989485, 1);
    double value = 0.5 + 0.5 * (double)ptex->u, richness = 0.2 + 0.7 * (double)ptex->v;
    for (int k = 0; k < 3; k++) {
        double away = fabs(fmod(hue + 2.0 * (3 - k), 6) - 3); /* from the opposite of channel k */
        double full = fmin(1, fmax(0, away - 1));
        rgb[k] = (float)(value * (1 - richness * (1 - full)));
    }
}

/* Sets the colour of a pixel; false if there is no value. *value is set for kinds with a scale
 * only. */
static bool colour_at(const struct painting *painting, size_t i, float rgb[3], double *value)
{
    if (painting->kind == sheen_ShowKind_SHOW_PTEX) {
        ptex_colour(&painting->ptex[i], rgb);
        return true;
    }
    if (painting->kind == sheen_ShowKind_SHOW_NORMAL) {
        for (int k = 0; k < 3; k++)
            rgb[k] = 0.5f + 0.5f * painting->normal[i][k];
        return isfinite(rgb[0] + rgb[1] + rgb[2]);
    }
    *value = value_at(painting, i);
    if (isfinite(*value))
        scale_colour(painting, *value, rgb);
    return isfinite(*value);
}

static bool is_empty(const struct painting *painting, size_t i)
{
    return painting->ptex ? painting->ptex[i].face == NO_FACE : isnan(painting->position[i][0]);
}

/* The pixel whose surface pixel i shows: i itself, or, if the centre of i sees no surface, the
 * first neighbour whose centre sees one. n_pixels when there is none. */
static size_t surface_near(const struct painting *painting, size_t i)
{
    static const int around[9][2] = {{0, 0},   {-1, 0}, {1, 0},  {0, -1}, {0, 1},
                                     {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    size_t width = painting->width_px, height = painting->n_pixels / width;
    for (int k = 0; k < 9; k++) {
        size_t x = i % width + (size_t)around[k][0], y = i / width + (size_t)around[k][1];
        if (x < width && y < height && !is_empty(painting, y * width + x)) /* -1 is large */
            return y * width + x;
    }
    return painting->n_pixels;
}

/* Blends only where needed: most pixels have share 1. */
static void paint_share(const float shown[4], const float empty[4], float share, float painted[4])
{
    if (share < 1)
        blend(shown, empty, share, painted);
    else
        memcpy(painted, shown, 4 * sizeof *painted);
}

/* Returns the value at the pixel's own centre; NaN if it has none. */
static double paint_pixel(const struct painting *painting, size_t i, const float miss[4],
                          const float empty[4], float painted[4])
{
    double value = NAN;
    float share = painting->coverage ? painting->coverage[i] : !is_empty(painting, i);
    size_t from = share > 0 ? surface_near(painting, i) : painting->n_pixels;
    float shown[4] = {0, 0, 0, 1};
    if (from == painting->n_pixels)
        memcpy(painted, empty, sizeof shown);
    else if (colour_at(painting, from, shown, &value))
        paint_share(shown, empty, share, painted);
    else
        paint_share(miss, empty, share, painted);
    return from == i && isfinite(value) ? value : NAN;
}

/* The least and the greatest value so far, and the pixels that have them. */
struct found {
    size_t n; /* values */
    size_t at_least, at_greatest;
    double least, greatest;
};

static void note(struct found *found, double value, size_t i)
{
    if (isnan(value))
        return;
    if (found->n == 0 || value < found->least) {
        found->least = value;
        found->at_least = i;
    }
    if (found->n == 0 || value > found->greatest) {
        found->greatest = value;
        found->at_greatest = i;
    }
    found->n++;
}

static void paint_pixels(const struct painting *painting, uint8_t (*rgba)[4], const float miss[4],
                         const float empty[4], struct found *found)
{
    for (size_t i = 0; i < painting->n_pixels; i++) {
        float painted[4];
        note(found, paint_pixel(painting, i, miss, empty, painted), i);
        blend_to_bytes(painted, rgba[i]);
    }
}

/* Where a pixel's centre lies outside a polygon, u and v are extrapolated beyond the face. */
static double within_face(float coordinate)
{
    return fmin(1, fmax(0, (double)coordinate));
}

/* Rounding to single precision may move a coordinate beyond the largest that the protocol
 * allows. */
static double within_range(float coordinate)
{
    return fmin(PROTOCOL_MAX_COORDINATE, fmax(-PROTOCOL_MAX_COORDINATE, (double)coordinate));
}

static sheen_Extreme extreme_at(const struct painting *painting, double value, size_t i,
                                bool has_place)
{
    const float *position = painting->position[i];
    sheen_Extreme extreme = {.value = value};
    if (!has_place)
        return extreme;
    extreme.has_x_px = extreme.has_y_px = extreme.has_position = true;
    extreme.x_px = (uint32_t)(i % painting->width_px);
    extreme.y_px = (uint32_t)(i / painting->width_px);
    extreme.position = (sheen_Vec3){within_range(position[0]), within_range(position[1]),
                                    within_range(position[2])};
    if (!painting->ptex)
        return extreme;
    extreme.has_face = extreme.has_u = extreme.has_v = true;
    extreme.face = painting->ptex[i].face;
    extreme.u = within_face(painting->ptex[i].u);
    extreme.v = within_face(painting->ptex[i].v);
    return extreme;
}

static void fill_extremes(const struct painting *painting, const struct found *found, double size,
                          struct false_colour_extremes *extremes)
{
    *extremes = (struct false_colour_extremes){.has_values = found->n > 0};
    if (!extremes->has_values)
        return;
    bool has_place = found->greatest - found->least > least_difference(painting, size);
    extremes->least = extreme_at(painting, found->least, found->at_least, has_place);
    extremes->greatest = extreme_at(painting, found->greatest, found->at_greatest, has_place);
}

/* --- the legend */

/* On the bar for DRAFT each of the four colours takes a quarter, whatever the range is. */
static void bar_colour(const void *context, double s, double t, float rgb[3])
{
    const struct painting *painting = context;
    double range = painting->range, x = 2 * s - 1;
    double deg =
        fabs(x) < 0.5 ? 2 * x * range : copysign(range + (2 * fabs(x) - 1) * (90 - range), x);
    switch (painting->kind) {
    case sheen_ShowKind_SHOW_NORMAL:
        for (int k = 0; k < 3; k++)
            rgb[k] = k == (int)(3 * s) ? 1 : 0.5f;
        break;
    case sheen_ShowKind_SHOW_PTEX:
        ptex_colour(&(struct ptex){1, (float)s, (float)t}, rgb);
        break;
    default:
        scale_colour(painting, painting->kind == sheen_ShowKind_SHOW_DRAFT ? deg : x * range, rgb);
    }
}

static void mark(struct legend *legend, double at, const char *text)
{
    struct legend_mark *next = &legend->marks[legend->n_marks++];
    next->at = at;
    snprintf(next->text, sizeof next->text, "%s", text);
}

static void add_marks(const struct painting *painting, struct legend *legend)
{
    char low[24], high[24];
    snprintf(low, sizeof low, "%.3g", -painting->range);
    snprintf(high, sizeof high, "%.3g", painting->range);
    switch (painting->kind) {
    case sheen_ShowKind_SHOW_NORMAL:
        mark(legend, 1.0 / 6, "x");
        mark(legend, 3.0 / 6, "y");
        mark(legend, 5.0 / 6, "z");
        break;
    case sheen_ShowKind_SHOW_PTEX:
        mark(legend, 0, "u = 0");
        mark(legend, 1, "u = 1");
        break;
    case sheen_ShowKind_SHOW_DRAFT:
        mark(legend, 0, "-90");
        mark(legend, 0.25, low);
        mark(legend, 0.5, "0");
        mark(legend, 0.75, high);
        mark(legend, 1, "90");
        break;
    default:
        mark(legend, 0, low);
        mark(legend, 0.5, "0");
        mark(legend, 1, high);
    }
}

static void add_legend(const struct painting *painting, const struct frame *frame)
{
    static const char *const titles[] = {
        [sheen_ShowKind_SHOW_CURVATURE] = "principal curvature, 1/unit",
        [sheen_ShowKind_SHOW_GAUSSIAN] = "Gaussian curvature, 1/unit^2",
        [sheen_ShowKind_SHOW_MEAN] = "mean curvature, 1/unit",
        [sheen_ShowKind_SHOW_NORMAL] = "normal",
        [sheen_ShowKind_SHOW_PTEX] = "Ptex face: u to the right, v up",
        [sheen_ShowKind_SHOW_DRAFT] = "draft angle, degrees",
    };
    struct legend legend = {
        .title = titles[painting->kind], .colour = bar_colour, .context = painting};
    add_marks(painting, &legend);
    legend_draw(frame->plane[0], frame->width_px, frame->height_px, &legend);
}

bool false_colour_has_legend(const sheen_Show *show)
{
    return !show->has_legend || show->legend;
}

void false_colour_paint(const struct frame *frame, sheen_Show *show, double size,
                        const float miss[4], const float empty[4],
                        struct false_colour_extremes *extremes)
{
    struct found found = {0};
    struct painting painting = {
        .kind = show->kind,
        .width_px = frame->width_px,
        .n_pixels = (size_t)frame->width_px * frame->height_px,
        .coverage = frame->plane[7],
        .position = frame->plane[1],
        .normal = frame->plane[2],
        .ptex = frame->plane[3],
        .curvature = frame->plane[5],
    };
    const double pull[3] = {show->direction.x, show->direction.y, show->direction.z};
    double length = hypot(hypot(pull[0], pull[1]), pull[2]);
    for (int i = 0; i < 3 && length > 0; i++)
        painting.pull[i] = pull[i] / length;
    bool is_scale =
        show->kind != sheen_ShowKind_SHOW_NORMAL && show->kind != sheen_ShowKind_SHOW_PTEX;
    if (is_scale && !show->has_range) {
        show->has_range = true;
        show->range = range_of(&painting, size);
    }
    painting.range = show->range;
    paint_pixels(&painting, frame->plane[0], miss, empty, &found);
    fill_extremes(&painting, &found, size, extremes);
    if (false_colour_has_legend(show))
        add_legend(&painting, frame);
}
