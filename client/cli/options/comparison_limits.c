#include "client/cli/options/comparison_limits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/options/options.h"
#include "client/cli/options/values.h"

/* Reads the share behind '@', in percent: "0.1%". */
static bool read_share(const char *text, double *share)
{
    static const struct range percent = {NULL, NULL, 0, 100, false, "percent"};
    char number[64], why[OPTIONS_WHY_BYTES];
    size_t n = strlen(text);
    if (n < 2 || n > sizeof(number) || text[n - 1] != '%')
        return false;
    memcpy(number, text, n - 1);
    number[n - 1] = 0;
    if (!options_number(&percent, number, share, why))
        return false;
    *share /= 100;
    return true;
}

bool comparison_limit_read(struct comparison_limit limits[static COMPARISON_ITEMS],
                           const char *text, char *why)
{
    const char *equals = strchr(text, '='), *at = strchr(text, '@');
    enum comparison_item item =
        equals ? comparison_item_of(text, (size_t)(equals - text)) : COMPARISON_ITEMS;
    if (item == COMPARISON_ITEMS)
        return options_refuse(why, "must be MEASURE=VALUE, with a MEASURE of distance, normal_deg, "
                                   "lines, line_length, curvature, uncovered_area, rotation_deg");
    struct comparison_limit *limit = &limits[item];
    char value[64];
    size_t n = at ? (size_t)(at - equals - 1) : strlen(equals + 1);
    if (n == 0 || n >= sizeof(value))
        return options_refuse(why, "has no number behind =, or one that is too long");
    memcpy(value, equals + 1, n);
    value[n] = 0;
    *limit = (struct comparison_limit){.is_given = true, .is_off = strcmp(value, "off") == 0};
    if (at && (limit->is_off || item == COMPARISON_ROTATION || !read_share(at + 1, &limit->share)))
        return options_refuse(why,
                              "needs behind @ the share of the area that may exceed the limit, as "
                              "a percentage from 0%% to 100%%; off and rotation_deg have none");
    const struct range range = comparison_range(item);
    return limit->is_off || options_number(&range, value, &limit->value, why);
}
