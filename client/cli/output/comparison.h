/* What `sheen compare` found about pairs of files, its verdict, and how it is shown: a table for people, JSON, JUnit,
 * markdown. Thread: one. */
#ifndef SHEEN_CLIENT_COMPARISON_H
#define SHEEN_CLIENT_COMPARISON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/cli/options/comparison_items.h"
#include "client/cli/output/json.h"
#include "client/lib/sheen.h"

enum comparison_verdict {
    COMPARISON_SAME, /* within all limits */
    COMPARISON_DIFFERS,
    COMPARISON_ADDED,   /* only the new file exists */
    COMPARISON_DELETED, /* only the old one */
    COMPARISON_FAILED,  /* one of them is bad, or the comparison was not possible */
};

struct compared_pair {
    const char *name;     /* of the pair */
    const char *files[2]; /* old, new; NULL: missing */
    uint8_t ids[2][SHEEN_ID_BYTES];
    bool has_unit; /* the file is in metres, from which the default limit of the distance comes */
    struct comparison_limit limits[COMPARISON_ITEMS];
    struct sheen_comparison comparison; /* if comparison_is_made() */
    enum comparison_verdict verdict;
    unsigned out; /* bit for each item that is out of tolerance */
    /* With COMPARISON_FAILED: why, the status, and the side whose file is the reason, or -1. */
    const char *failure;
    enum sheen_status status;
    int failed_side;
};

/* True if both files were compared: the pair has measures. */
static inline bool comparison_is_made(const struct compared_pair *pair)
{
    return pair->verdict == COMPARISON_SAME || pair->verdict == COMPARISON_DIFFERS;
}

/* How many pairs have a verdict. */
size_t comparison_count(const struct compared_pair *pairs, size_t n,
                        enum comparison_verdict verdict);
/* "3 within limits, 1 not", and ", 1 failed" if some are. */
#define COMPARISON_COUNTS_BYTES 100
void comparison_counts(const struct compared_pair *pairs, size_t n,
                       char text[static COMPARISON_COUNTS_BYTES]);

const char *comparison_verdict_name(enum comparison_verdict verdict);
/* True if both files were compared and no measure differs from 0. */
bool comparison_is_identical(const struct compared_pair *pair);
/* The verdict for people: "same" only where all measures are 0, else "within limits". */
const char *comparison_verdict_text(const struct compared_pair *pair);

/* Takes the limits that the daemon used into pair->limits, and judges the pair. */
void comparison_judge(struct compared_pair *pair);

/* The worst value of an item over both sides, with its sign; NAN: it has none. */
double comparison_value(const struct compared_pair *pair, enum comparison_item item);
/* The side whose samples found the worst value of a measure. */
const struct sheen_compared_side *comparison_worst_side(const struct sheen_comparison *comparison,
                                                        enum comparison_item item);
/* The larger share of the area of both sides that is beyond the limit of an item. */
double comparison_share_out(const struct compared_pair *pair, enum comparison_item item);

void comparison_print(const struct compared_pair *pairs, size_t n);
/* One object by client/schema/compare-1.json. */
void comparison_write_json(struct json *json, const struct compared_pair *pairs, size_t n);
/* JUnit: a suite for each pair, a case for each item. malloc'd; NULL when memory is short. */
char *comparison_junit(const struct compared_pair *pairs, size_t n, int64_t when_s,
                       size_t *n_bytes);
/* Markdown for summaries of jobs. malloc'd; NULL when memory is short. */
char *comparison_markdown(const struct compared_pair *pairs, size_t n, size_t *n_bytes);

/* One line about an item: its worst value, its limit, and the place. */
#define COMPARISON_LINE_BYTES 400
void comparison_line(const struct compared_pair *pair, enum comparison_item item,
                     char line[static COMPARISON_LINE_BYTES]);

#endif
