/* Writes where the lines of a surface break: as JSON, as a table for people, and as a JUnit report. The limits of
 * `options` tell which limits are defaults.
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_BREAKS_REPORT_H
#define SHEEN_CLIENT_BREAKS_REPORT_H

#include "client/cli/options/options.h"
#include "client/cli/output/json.h"

/* One object, by client/schema/breaks-1.json. */
void breaks_json(struct json *json, const struct options *options,
                 const uint8_t model_id[SHEEN_ID_BYTES], const struct sheen_breaks *breaks);

/* The table on standard output, the worst edge first. */
void breaks_table(const struct options *options, const struct sheen_breaks *breaks);

/* A report with a test case for each limit, malloc'd; NULL when memory is short. */
char *breaks_junit(const struct options *options, const struct sheen_breaks *breaks,
                   size_t *n_bytes);

#endif
