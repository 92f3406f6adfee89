/* The limit tables of an OBJ, for the tests of what is drawn or evaluated from them. */
#ifndef SHEEN_TESTS_CAGE_TABLES_H
#define SHEEN_TESTS_CAGE_TABLES_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/cage/read/read.h"
#include "server/limit/tables.h"

static inline void build(const char *bytes, size_t size, struct limit_tables *tables)
{
    struct cage cage;
    struct error error = {0};
    if (!cage_read(&cage, bytes, size, "scene.obj", &error))
        fail_msg("%s", error.text);
    struct limit_plan *plan = limit_plan_create(&cage, NULL, &error);
    assert_non_null(plan);
    assert_true(limit_tables_init(tables, plan, &error));
    assert_true(limit_build_faces(tables, plan, 0, tables->n_faces, NULL, &error));
    limit_plan_destroy(plan);
    cage_finish(&cage);
}

static inline void build_file(const char *path, struct limit_tables *tables)
{
    static char bytes[1 << 20];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    build(bytes, size, tables);
}

/* A torus of n x n quads: smooth, and regular all over. */
static inline void build_torus(unsigned n, struct limit_tables *tables)
{
    size_t room = (size_t)n * n * 100, used = 0;
    char *text = malloc(room);
    assert_non_null(text);
    for (unsigned k = 0; k < n * n; k++) {
        double a = 6.283185307179586 * (k / n) / n, b = 6.283185307179586 * (k % n) / n;
        double r = 2 + cos(b);
        used += (size_t)snprintf(text + used, room - used, "v %.12f %.12f %.12f\n", r * cos(a),
                                 r * sin(a), sin(b));
    }
    for (unsigned k = 0; k < n * n; k++) {
        unsigned i = k / n, j = k % n, i2 = (i + 1) % n, j2 = (j + 1) % n;
        used += (size_t)snprintf(text + used, room - used, "f %u %u %u %u\n", i * n + j + 1,
                                 i2 * n + j + 1, i2 * n + j2 + 1, i * n + j2 + 1);
    }
    build(text, used, tables);
    free(text);
}

#endif
