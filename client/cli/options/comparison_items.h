/* What has a limit in `sheen compare`. Pure, any thread. */
#ifndef SHEEN_CLIENT_COMPARISON_ITEMS_H
#define SHEEN_CLIENT_COMPARISON_ITEMS_H

#include <stdbool.h>
#include <stddef.h>

#include "client/lib/sheen.h"
#include "protocol/ranges.h"

/* What has a limit: the measures of sheen_compare(), and two more. */
enum comparison_item {
    COMPARISON_MISSING = SHEEN_N_COMPARE_MEASURES, /* area without a counterpart, square units */
    COMPARISON_ROTATION,                           /* of the alignment, degrees */
    COMPARISON_ITEMS,
};

struct comparison_limit {
    double value;  /* 0 and not is_given: the default */
    double share;  /* of the area that may be beyond it, 0 to 1 */
    bool is_given; /* on the command line */
    bool is_off;   /* not judged */
};

/* The range of an item's limit; that of an area is one of lengths, and 0. */
struct range comparison_range(enum comparison_item item);
/* The key of an item, as on the command line and in JSON. */
const char *comparison_key(enum comparison_item item);
/* The item of a key of n bytes; COMPARISON_ITEMS: none. */
enum comparison_item comparison_item_of(const char *key, size_t n);

#endif
