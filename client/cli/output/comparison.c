#include "client/cli/output/comparison.h"

#include <math.h>
#include <stdio.h>

static const char *unit_of(enum comparison_item item)
{
    static const char *const units[COMPARISON_ITEMS] = {
        [SHEEN_COMPARE_DISTANCE] = "units", [SHEEN_COMPARE_NORMAL] = "degrees",
        [SHEEN_COMPARE_LINES] = "spacings", [SHEEN_COMPARE_LINE_LENGTH] = "units",
        [SHEEN_COMPARE_CURVATURE] = "",     [COMPARISON_MISSING] = "square units",
        [COMPARISON_ROTATION] = "degrees",
    };
    return units[item];
}

const char *comparison_verdict_name(enum comparison_verdict verdict)
{
    static const char *const names[] = {"same", "differs", "added", "deleted", "failed"};
    return names[verdict];
}

size_t comparison_count(const struct compared_pair *pairs, size_t n,
                        enum comparison_verdict verdict)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        count += pairs[i].verdict == verdict;
    return count;
}

void comparison_counts(const struct compared_pair *pairs, size_t n,
                       char text[static COMPARISON_COUNTS_BYTES])
{
    size_t same = comparison_count(pairs, n, COMPARISON_SAME),
           failed = comparison_count(pairs, n, COMPARISON_FAILED);
    int used = snprintf(text, COMPARISON_COUNTS_BYTES, "%zu within limits, %zu not", same,
                        n - same - failed);
    if (failed)
        snprintf(text + used, COMPARISON_COUNTS_BYTES - (size_t)used, ", %zu failed", failed);
}

const struct sheen_compared_side *comparison_worst_side(const struct sheen_comparison *comparison,
                                                        enum comparison_item item)
{
    const struct sheen_compared_side *sides = comparison->sides;
    const struct sheen_compared_measure *old = &sides[0].measures[item],
                                        *new = &sides[1].measures[item];
    bool is_new = new->is_known && (!old->is_known || fabs(new->worst) > fabs(old->worst));
    return &sides[is_new];
}

double comparison_value(const struct compared_pair *pair, enum comparison_item item)
{
    const struct sheen_comparison *comparison = &pair->comparison;
    if (item == COMPARISON_MISSING)
        return comparison->sides[0].area_uncovered + comparison->sides[1].area_uncovered;
    if (item == COMPARISON_ROTATION)
        return comparison->is_aligned ? comparison->rotation_deg : (double)NAN;
    const struct sheen_compared_measure *measure =
        &comparison_worst_side(comparison, item)->measures[item];
    return measure->is_known ? measure->worst : (double)NAN;
}

double comparison_share_out(const struct compared_pair *pair, enum comparison_item item)
{
    double most = 0;
    for (int k = 0; k < 2; k++) {
        const struct sheen_compared_side *side = &pair->comparison.sides[k];
        double out = item == COMPARISON_MISSING    ? side->area_uncovered
                     : item == COMPARISON_ROTATION ? 0
                                                   : side->measures[item].area_out;
        if (side->area > 0)
            most = fmax(most, out / side->area);
    }
    return most;
}

bool comparison_is_identical(const struct compared_pair *pair)
{
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        if (fabs(comparison_value(pair, (enum comparison_item)k)) > 0)
            return false;
    return comparison_is_made(pair);
}

const char *comparison_verdict_text(const struct compared_pair *pair)
{
    bool is_within = pair->verdict == COMPARISON_SAME && !comparison_is_identical(pair);
    return is_within ? "within limits" : comparison_verdict_name(pair->verdict);
}

/* A limit without a share is exceeded by one place, one with a share by more area than that. */
static bool is_out(const struct compared_pair *pair, enum comparison_item item)
{
    const struct comparison_limit *limit = &pair->limits[item];
    double value = fabs(comparison_value(pair, item));
    if (limit->is_off || !(value > limit->value))
        return false;
    return limit->share == 0 || comparison_share_out(pair, item) > limit->share;
}

void comparison_judge(struct compared_pair *pair)
{
    for (int k = 0; k < SHEEN_N_COMPARE_MEASURES; k++)
        pair->limits[k].value = pair->comparison.limits[k];
    if (!pair->limits[COMPARISON_ROTATION].is_given)
        pair->limits[COMPARISON_ROTATION].value = 1;
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        if (is_out(pair, (enum comparison_item)k))
            pair->out |= 1u << k;
    pair->verdict = pair->out ? COMPARISON_DIFFERS : COMPARISON_SAME;
}

void comparison_line(const struct compared_pair *pair, enum comparison_item item,
                     char line[static COMPARISON_LINE_BYTES])
{
    const struct comparison_limit *limit = &pair->limits[item];
    const struct sheen_comparison *comparison = &pair->comparison;
    const struct sheen_compared_place *at = NULL;
    if (item < (enum comparison_item)SHEEN_N_COMPARE_MEASURES) {
        const struct sheen_compared_measure *measure =
            &comparison_worst_side(comparison, item)->measures[item];
        at = measure->is_known && measure->worst != 0 ? &measure->at[0] : NULL;
    } else if (item == COMPARISON_MISSING) {
        bool is_new = comparison->sides[1].area_uncovered > comparison->sides[0].area_uncovered;
        const struct sheen_compared_side *side = &comparison->sides[is_new];
        at = side->has_uncovered ? &side->uncovered : NULL;
    }
    int n = snprintf(line, COMPARISON_LINE_BYTES, "%s %.6g %s, limit %.6g", comparison_key(item),
                     comparison_value(pair, item), unit_of(item), limit->value);
    if (limit->share > 0)
        n += snprintf(line + n, COMPARISON_LINE_BYTES - (size_t)n, " over %.6g %% of the area",
                      100 * limit->share);
    if (item != COMPARISON_ROTATION)
        n += snprintf(line + n, COMPARISON_LINE_BYTES - (size_t)n,
                      ", %.4g %% of the area is beyond", 100 * comparison_share_out(pair, item));
    if (at)
        snprintf(line + n, COMPARISON_LINE_BYTES - (size_t)n,
                 ", at %.9g,%.9g,%.9g, face %u, u %.6f, v %.6f", at->position[0], at->position[1],
                 at->position[2], at->face, at->uv[0], at->uv[1]);
}

/* --- the table */

static void print_limit_source(const struct compared_pair *pair)
{
    const struct comparison_limit *limit = &pair->limits[SHEEN_COMPARE_DISTANCE];
    if (limit->is_given)
        return;
    printf("  limit of the distance: %.4g units, %s\n", limit->value,
           pair->has_unit
               ? "0.05 mm, because files of glTF are in metres"
               : "1e-5 of the diagonal of the old model's box, because the file does not "
                 "name its unit");
}

static void print_item(const struct compared_pair *pair, enum comparison_item item)
{
    const struct sheen_comparison *comparison = &pair->comparison;
    double value = comparison_value(pair, item);
    if (isnan(value))
        return;
    char limit[32] = "-";
    if (!pair->limits[item].is_off && isfinite(pair->limits[item].value))
        snprintf(limit, sizeof(limit), "%.4g", pair->limits[item].value);
    printf("  %-15s %11.4g %10s %s", comparison_key(item), value, limit,
           pair->out >> item & 1 ? "OUT" : "   ");
    if (item >= (enum comparison_item)SHEEN_N_COMPARE_MEASURES) {
        printf("\n");
        return;
    }
    const struct sheen_compared_measure *measure =
        &comparison_worst_side(comparison, item)->measures[item];
    printf(" %10.3g %10.3g %8.3g %%", measure->rms, measure->p99,
           100 * comparison_share_out(pair, item));
    if (measure->worst != 0)
        printf("  %.6g,%.6g,%.6g face %u", measure->at[0].position[0], measure->at[0].position[1],
               measure->at[0].position[2], measure->at[0].face);
    printf("\n");
}

static void print_pair(const struct compared_pair *pair)
{
    const struct sheen_comparison *comparison = &pair->comparison;
    printf("%s: %s\n", pair->name, comparison_verdict_text(pair));
    if (pair->verdict == COMPARISON_FAILED)
        printf("  %s\n", pair->failure);
    if (!comparison_is_made(pair))
        return;
    printf("  %-15s %11s %10s %3s %10s %10s %10s  %s\n", "", "worst", "limit", "", "rms", "p99",
           "area out", "where, on the old surface");
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        print_item(pair, (enum comparison_item)k);
    print_limit_source(pair);
    printf("  %llu samples; equal surfaces of different files differ by up to %.2g units and %.1g "
           "degrees\n",
           (unsigned long long)(comparison->sides[0].samples + comparison->sides[1].samples),
           comparison->distance_floor, comparison->normal_floor_deg);
    double rewound = fmax(comparison->sides[0].area_rewound / comparison->sides[0].area,
                          comparison->sides[1].area_rewound / comparison->sides[1].area);
    if (rewound > 0)
        printf("  notice: %.3g %% of the area is wound the other way around; normals are compared "
               "up to winding\n",
               100 * rewound);
    if (comparison->is_aligned)
        printf("  aligned by a rotation of %.6g degrees and a shift of %.6g,%.6g,%.6g: root mean "
               "square of the distance %.3g before, %.3g after\n",
               comparison->rotation_deg, comparison->shift[0], comparison->shift[1],
               comparison->shift[2], comparison->rms_before, comparison->rms_after);
    if (comparison->free_directions > 0)
        printf("  notice: the new surface slides along itself in %u of 6 directions, as flat and "
               "round parts "
               "do: no motion in them was looked for\n",
               comparison->free_directions);
}

void comparison_print(const struct compared_pair *pairs, size_t n)
{
    char counts[COMPARISON_COUNTS_BYTES];
    for (size_t i = 0; i < n; i++)
        print_pair(&pairs[i]);
    comparison_counts(pairs, n, counts);
    if (n > 1)
        printf("%zu pairs: %s\n", n, counts);
}
