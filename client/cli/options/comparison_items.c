#include "client/cli/options/comparison_items.h"

#include <string.h>

static const struct {
    const char *key;
    enum range_name range;
    bool is_zero_allowed; /* 0 as a limit: nothing may exceed it */
} ITEMS[COMPARISON_ITEMS] = {
    [SHEEN_COMPARE_DISTANCE] = {"distance", RANGE_COMPARE_DISTANCE},
    [SHEEN_COMPARE_NORMAL] = {"normal_deg", RANGE_COMPARE_NORMAL},
    [SHEEN_COMPARE_LINES] = {"lines", RANGE_COMPARE_LINES},
    [SHEEN_COMPARE_LINE_LENGTH] = {"line_length", RANGE_COMPARE_LENGTH},
    [SHEEN_COMPARE_CURVATURE] = {"curvature", RANGE_COMPARE_CURVATURE},
    [COMPARISON_MISSING] = {"uncovered_area", RANGE_COMPARE_LENGTH, true},
    [COMPARISON_ROTATION] = {"rotation_deg", RANGE_COMPARE_NORMAL},
};

struct range comparison_range(enum comparison_item item)
{
    struct range range = RANGES[ITEMS[item].range];
    range.above_least = range.above_least && !ITEMS[item].is_zero_allowed;
    return range;
}

const char *comparison_key(enum comparison_item item)
{
    return ITEMS[item].key;
}

enum comparison_item comparison_item_of(const char *key, size_t n)
{
    int item = 0;
    while (item < COMPARISON_ITEMS &&
           (strlen(ITEMS[item].key) != n || memcmp(ITEMS[item].key, key, n) != 0))
        item++;
    return (enum comparison_item)item;
}
