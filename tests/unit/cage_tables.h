/* Builds the limit tables of a model, for tests of drawing and evaluation. */
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
#include "server/surface/plan/surface_plan.h"
#include "server/surface/tables.h"
#include "server/surface/vec.h"

static inline void build_cage(const struct cage *cage, bool stored, struct limit_tables *tables)
{
    struct error error = {0};
    struct surface_plan plan;
    assert_true(surface_plan_init(&plan, cage, NULL, &error));
    assert_true((stored ? limit_tables_init
                        : limit_tables_init_on_demand)(tables, surface_plan_size(&plan), &error));
    assert_true(surface_build_faces(tables, &plan, 0, tables->n_faces, NULL, &error));
    surface_plan_finish(&plan);
}

static inline void build_as(const char *name, const char *bytes, size_t size, bool stored,
                            struct limit_tables *tables)
{
    struct cage cage;
    struct error error = {0};
    if (!cage_read(&cage, bytes, size, name, &error))
        fail_msg("%s", error.text);
    build_cage(&cage, stored, tables);
    cage_finish(&cage);
}

static inline void build(const char *bytes, size_t size, struct limit_tables *tables)
{
    build_as("scene.obj", bytes, size, true, tables);
}

static inline void build_file_as(const char *path, bool stored, struct limit_tables *tables)
{
    static char bytes[1 << 20];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    build_as(path, bytes, size, stored, tables);
}

static inline void build_file(const char *path, struct limit_tables *tables)
{
    build_file_as(path, true, tables);
}

/* Builds tables on demand, without points. */
static inline void build_file_on_demand(const char *path, struct limit_tables *tables)
{
    build_file_as(path, false, tables);
}

/* A torus of n x n quads. It is smooth, and all its vertices are regular. */
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

/* One bicubic Bezier patch as a cage: its 16 B-spline points. Of the nine faces only the middle
 * one, BEZIER_FACE, has a surface (boundary mode NONE). */
enum { BEZIER_FACE = 4 };

static inline void build_bezier(struct vec bezier[4][4], struct limit_tables *tables)
{
    static const double weight[4][4] = {{6, -7, 2, 0}, {0, 2, -1, 0}, {0, -1, 2, 0}, {0, 2, -7, 6}};
    char text[4000];
    int used = 0;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            struct vec p = {0, 0, 0};
            for (int n = 0; n < 16; n++)
                p = vec_mad(p, weight[j][n / 4] * weight[i][n % 4], bezier[n / 4][n % 4]);
            used += sprintf(text + used, "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
        }
    }
    for (int k = 1; k <= 11; k++)
        if (k % 4)
            used += sprintf(text + used, "f %d %d %d %d\n", k, k + 1, k + 5, k + 4);
    used += sprintf(text + used, "t interpolateboundary 1/0/0 0\n");
    build(text, (size_t)used, tables);
}

/* Nearly an eighth of a sphere about the origin, whose last row (or, turned, column) is its north
 * pole. */
static inline void build_octant(bool turned, struct limit_tables *tables)
{
    const double k = 0.5522847498307936, arc[4][2] = {{1, 0}, {1, k}, {k, 1}, {0, 1}};
    struct vec bezier[4][4];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            *(turned ? &bezier[3 - i][j] : &bezier[j][i]) =
                (struct vec){arc[j][0] * arc[i][0], arc[j][0] * arc[i][1], arc[j][1]};
    build_bezier(bezier, tables);
}

#endif
