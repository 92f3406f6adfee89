/* The result of `sheen compare` as JUnit and as markdown. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/output/comparison.h"
#include "client/cli/output/junit.h"

/* --- JUnit */

/* The cases of a pair, one for each item that is judged; `lines` has their texts. Returns their number. */
static size_t make_cases(const struct compared_pair *pair, struct junit_case *cases,
                         char (*lines)[COMPARISON_LINE_BYTES])
{
    size_t n = 0;
    if (pair->verdict == COMPARISON_FAILED) {
        cases[0] = (struct junit_case){.name = "files", .failure = pair->failure, .is_error = true};
        return 1;
    }
    if (!comparison_is_made(pair)) {
        cases[0] = (struct junit_case){.name = "files",
                                       .failure = pair->files[0]
                                                      ? "deleted: there is no new file of this name"
                                                      : "added: there is no old file of this name"};
        return 1;
    }
    for (int k = 0; k < COMPARISON_ITEMS; k++) {
        enum comparison_item item = (enum comparison_item)k;
        const struct comparison_limit *limit = &pair->limits[k];
        if (isnan(comparison_value(pair, item)) || limit->is_off || !isfinite(limit->value))
            continue;
        comparison_line(pair, item, lines[n]);
        cases[n] = (struct junit_case){.name = comparison_key(item),
                                       .failure = pair->out >> k & 1 ? lines[n] : NULL};
        n++;
    }
    return n;
}

char *comparison_junit(const struct compared_pair *pairs, size_t n, int64_t when_s, size_t *n_bytes)
{
    struct junit_suite *suites = calloc(n, sizeof(*suites));
    struct junit_case *cases = calloc(n, COMPARISON_ITEMS * sizeof(*cases));
    char(*lines)[COMPARISON_LINE_BYTES] = calloc(n, COMPARISON_ITEMS * sizeof(*lines));
    char *text = NULL;
    if (suites && cases && lines) {
        for (size_t i = 0; i < n; i++) {
            struct junit_case *own = cases + i * COMPARISON_ITEMS;
            size_t n_cases = make_cases(&pairs[i], own, lines + i * COMPARISON_ITEMS);
            suites[i] = (struct junit_suite){pairs[i].name, own, n_cases,
                                             (double)pairs[i].comparison.total_us / 1e6};
        }
        text = junit_write(suites, n, when_s, n_bytes);
    }
    free(suites);
    free(cases);
    free(lines);
    return text;
}

/* --- markdown */

enum { MOST_ROWS = 20 };

/* A name in a table: characters that markdown or HTML would interpret are written as their numbers. */
static void put_name(FILE *out, const char *name)
{
    for (; *name; name++) {
        unsigned char c = (unsigned char)*name;
        if (c < 0x20 || c == 0x7f)
            fputc('?', out);
        else if (strchr("&<>\"|*_`[]()#!\\~", c))
            fprintf(out, "&#%d;", c);
        else
            fputc(c, out);
    }
}

/* How far the worst item of a pair is over its limit; infinity for a missing or bad file. */
static double badness(const struct compared_pair *pair)
{
    double most = 0;
    if (!comparison_is_made(pair))
        return INFINITY;
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        if (pair->out >> k & 1)
            most = fmax(most, pair->limits[k].value > 0
                                  ? fabs(comparison_value(pair, (enum comparison_item)k)) /
                                        pair->limits[k].value
                                  : (double)INFINITY);
    return most;
}

static int by_badness(const void *a, const void *b)
{
    double x = badness(*(const struct compared_pair *const *)a),
           y = badness(*(const struct compared_pair *const *)b);
    return (x < y) - (x > y);
}

static void put_pair(FILE *out, const struct compared_pair *pair)
{
    fputs("| ", out);
    put_name(out, pair->name);
    fprintf(out, " | %s |", comparison_verdict_text(pair));
    for (int k = 0; k < COMPARISON_ITEMS; k++) {
        double value = comparison_is_made(pair) ? comparison_value(pair, (enum comparison_item)k)
                                                : (double)NAN;
        if (isnan(value))
            fputs("  |", out);
        else
            fprintf(out, pair->out >> k & 1 ? " **%.3g** |" : " %.3g |", value);
    }
    fputc('\n', out);
}

/* Why a pair has no numbers, below the table. */
static void put_failure(FILE *out, const struct compared_pair *pair)
{
    if (pair->verdict != COMPARISON_FAILED)
        return;
    fputs("\n", out);
    put_name(out, pair->name);
    fputs(": ", out);
    put_name(out, pair->failure);
    fputs("\n", out);
}

char *comparison_markdown(const struct compared_pair *pairs, size_t n, size_t *n_bytes)
{
    char *text = NULL;
    const struct compared_pair **sorted = calloc(n, sizeof(*sorted));
    FILE *out = sorted ? open_memstream(&text, n_bytes) : NULL;
    if (!out) {
        free(sorted);
        return NULL;
    }
    char counts[COMPARISON_COUNTS_BYTES];
    for (size_t i = 0; i < n; i++)
        sorted[i] = &pairs[i];
    comparison_counts(pairs, n, counts);
    qsort(sorted, n, sizeof(*sorted), by_badness);
    fprintf(out, "### sheen compare: %s\n\n| pair | verdict |", counts);
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        fprintf(out, " %s |", comparison_key((enum comparison_item)k));
    fputs("\n|---|---|", out);
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        fputs("---|", out);
    fputc('\n', out);
    for (size_t i = 0; i < n && i < MOST_ROWS; i++)
        put_pair(out, sorted[i]);
    for (size_t i = 0; i < n && i < MOST_ROWS; i++)
        put_failure(out, sorted[i]);
    if (n > MOST_ROWS)
        fprintf(out, "\nThe %d worst of %zu pairs.\n", MOST_ROWS, n);
    free(sorted);
    bool ok = !ferror(out);
    if (fclose(out) == 0 && ok)
        return text;
    free(text);
    return NULL;
}
