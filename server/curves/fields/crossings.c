#include "server/curves/fields/crossings.h"

#include <math.h>

void patch_field_init(struct patch_field *on, const struct line_field *field,
                      const struct bezier *bezier)
{
    double reach = 0;
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < 16; k++)
            reach = fmax(reach, fabs(bezier->p[d][k / 4][k % 4]));
    *on = (struct patch_field){field, bezier, {{0}, 0}};
    field_find_bounds(field, bezier->origin, reach, &on->bounds);
}

double patch_field_noise(const struct patch_field *on, const struct field_line *line)
{
    return LINE_NOISE * field_bound(&on->bounds, line);
}

void patch_field_jet(const struct patch_field *on, const struct field_line *line,
                     const double at[2], struct bezier_jet *surface, double jet[3])
{
    struct bezier_jet own = {.s = {{0, 0, 0}}}, *out = surface ? surface : &own;
    bezier_jet_at(on->bezier, at[0], at[1], out);
    /* F needs no unit length of the normal, but its powers must not overflow or vanish. */
    struct vec n = out->n[0];
    double largest = fmax(fmax(fabs(n.x), fabs(n.y)), fabs(n.z));
    for (int k = 0; k < 3 && largest > 0; k++)
        out->n[k] = vec_scale(out->n[k], 1 / largest);
    field_jet(on->field, line, on->bezier->origin, out, jet);
}

bool patch_field_is_negative(const struct patch_field *on, const struct field_line *line,
                             const double at[2])
{
    double jet[3];
    patch_field_jet(on, line, at, NULL, jet);
    return jet[0] < -patch_field_noise(on, line);
}

int line_range_sign(const double range[RANGE_SIZE], double noise)
{
    double middle = range[0] + noise, off = (1 + 1e-9) * range[RANGE_OFF];
    return middle > off ? 1 : middle < -off ? -1 : 0;
}

void crossings_init(struct crossings *crossings, const struct patch_field *on,
                    const struct segment *segment)
{
    struct piece_range range;
    crossings->segment = *segment;
    segment_find_range(segment, &range);
    field_find_range(on->field, on->bezier->origin, &range, &crossings->terms);
}

/* One line along one segment. */
struct finding {
    const struct patch_field *on;
    const struct field_line *line;
    const struct segment *whole;
    double noise, *at;
    int n, n_parts;
};

/* F, with the noise added, and its derivative at t along the whole segment. */
static double value_at(const struct finding *finding, double t, double *slope)
{
    const struct segment *whole = finding->whole;
    double by[2] = {whole->to[0] - whole->from[0], whole->to[1] - whole->from[1]}, jet[3];
    const double at[2] = {whole->from[0] + t * by[0], whole->from[1] + t * by[1]};
    patch_field_jet(finding->on, finding->line, at, NULL, jet);
    *slope = jet[1] * by[0] + jet[2] * by[1];
    return jet[0] + finding->noise;
}

/* The crossing between a and b, where F has different signs: Newton's method within a bracket. */
static double only_crossing(const struct finding *finding, double a, double b, bool negative)
{
    double t = 0.5 * (a + b);
    for (int i = 0; i < 100 && b - a > 0x1p-50; i++) {
        double slope, f = value_at(finding, t, &slope), to = t - f / slope;
        *((f < 0) == negative ? &a : &b) = t;
        if (f == 0 || fabs(to - t) < 0x1p-51)
            return to > a && to < b ? to : t;
        t = to > a && to < b && i % 8 != 7 ? to : 0.5 * (a + b);
    }
    return t;
}

/* Is F 0, but for rounding, everywhere? */
static bool is_flat(const struct finding *finding)
{
    for (int k = 1; k < 8; k++) {
        double slope, f = value_at(finding, k / 8.3, &slope) - finding->noise;
        if (!(fabs(f) <= 0.5 * finding->noise))
            return false;
    }
    return true;
}

enum { MOST_PARTS = 400 };

/* Beyond MOST_CROSSINGS the crossing and the one before it are left out: F has the same sign on
 * both sides of the two. The recursion can come here with a full list, because each part that waits
 * on its way adds a crossing. */
static void add_crossing(struct finding *finding, double t)
{
    if (finding->n < MOST_CROSSINGS)
        finding->at[finding->n++] = t;
    else
        finding->n--;
}

static void find_between(struct finding *finding, const struct segment *segment,
                         const struct field_range *terms, double a, double b,
                         const bool negative[2])
{
    double range[RANGE_SIZE];
    bool differ = negative[0] != negative[1];
    field_line_range(terms, finding->line, range);
    bool is_known = line_range_sign(range, finding->noise) ||
                    range_slope_sign(range, 0, finding->noise) || b - a < 0x1p-40 ||
                    !isfinite(finding->noise) || ++finding->n_parts > MOST_PARTS ||
                    finding->n > MOST_CROSSINGS - 4 || (finding->n_parts == 1 && is_flat(finding));
    if (is_known) {
        if (differ)
            add_crossing(finding, only_crossing(finding, a, b, negative[0]));
        return;
    }
    struct segment half[2];
    double middle = 0.5 * (a + b), slope;
    bool at_middle = value_at(finding, middle, &slope) < 0;
    segment_halve(segment, half);
    for (int k = 0; k < 2; k++) {
        struct crossings part;
        const bool ends[2] = {k ? at_middle : negative[0], k ? negative[1] : at_middle};
        crossings_init(&part, finding->on, &half[k]);
        find_between(finding, &half[k], &part.terms, k ? middle : a, k ? b : middle, ends);
    }
}

int crossings_find(const struct crossings *crossings, const struct patch_field *on,
                   const struct field_line *line, const bool negative[2], double at[MOST_CROSSINGS],
                   size_t *n_parts)
{
    struct finding finding = {on, line, &crossings->segment, patch_field_noise(on, line), at, 0, 0};
    find_between(&finding, &crossings->segment, &crossings->terms, 0, 1, negative);
    *n_parts += (size_t)finding.n_parts;
    return finding.n;
}

double crossings_only(const struct segment *segment, const struct patch_field *on,
                      const struct field_line *line, bool is_negative_first)
{
    struct finding finding = {on, line, segment, patch_field_noise(on, line), NULL, 0, 0};
    return only_crossing(&finding, 0, 1, is_negative_first);
}
