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

/* Adds the line at `place` to the set; lines of one field follow each other. False if there is no such line. */
static inline bool set_add(struct line_set *set, const struct line_map *map, double place)
{
    struct line_field field;
    struct field_line line;
    if (!line_field_init(&field, map, place) || !field_line_init(&field, place, &line))
        return false;
    if (set->n_fields == 0 || set->field[set->n_fields - 1].form != field.form)
        set->field[set->n_fields++] = field;
    set->line[set->n_lines++] = line;
    set->first_line[set->n_fields] = set->n_lines;
    return true;
}

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
