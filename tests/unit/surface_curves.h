/* Runs the computation of lines on tables, for tests. */
#ifndef SHEEN_TESTS_SURFACE_CURVES_H
#define SHEEN_TESTS_SURFACE_CURVES_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/curves/lines/surface_lines.h"

static inline struct surface_lines *trace_set(const struct limit_tables *tables,
                                              const struct line_set *set, double tolerance)
{
    struct error error = {0};
    struct surface_lines *lines =
        surface_lines_create(tables, set, tolerance, (size_t)1 << 30, &error);
    if (!lines || !computation_run(surface_lines_computation(lines), &error))
        fail_msg("%s", error.text);
    return lines;
}

#endif
