#include "client/cli/output/pick.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define NO_FACE UINT32_MAX

static bool has_surface(const struct pick *pick)
{
    return pick->face != NO_FACE;
}

static double mean(const struct pick *pick)
{
    return 0.5 * ((double)pick->curvature[0] + (double)pick->curvature[1]);
}

static double gaussian(const struct pick *pick)
{
    return (double)pick->curvature[0] * (double)pick->curvature[1];
}

/* The smallest radius of curvature in any direction; infinite where the surface is flat. */
static double radius(const struct pick *pick)
{
    return 1 / fmax(fabs((double)pick->curvature[0]), fabs((double)pick->curvature[1]));
}

static void print_floats(const char *name, const float *value, size_t n)
{
    printf("%-16s", name);
    for (size_t i = 0; i < n; i++)
        printf(" %.9g", (double)value[i]);
    putchar('\n');
}

void pick_print_table(const struct pick *pick)
{
    printf("%-16s %.9g %.9g\n", "pixel", pick->x, pick->y);
    if (!has_surface(pick)) {
        puts("nothing there   no surface is visible at this place");
        return;
    }
    print_floats("point", pick->point, 3);
    if (isnan(pick->normal[0])) {
        puts("normal           none");
    } else {
        print_floats("normal", pick->normal, 3);
        print_floats("curvatures", pick->curvature, 2);
        printf("%-16s %.9g\n%-16s %.9g\n", "mean", mean(pick), "gaussian", gaussian(pick));
        if (isinf(radius(pick)))
            puts("radius           none, flat");
        else
            printf("%-16s %.9g\n", "radius", radius(pick));
    }
    printf("%-16s %" PRIu32 "\n", "face", pick->face);
    print_floats("u v", pick->uv, 2);
    if (isnan(pick->light[0]))
        puts("light            not met");
    else
        print_floats("light", pick->light, 2);
}

/* Writes a field of a CSV line; nothing for NaN. */
static void print_field(double value)
{
    if (isnan(value))
        putchar(',');
    else
        printf(",%.9g", value);
}

void pick_print_csv(const struct pick *picks, size_t n)
{
    puts("x,y,point.x,point.y,point.z,normal.x,normal.y,normal.z,k.min,k.max,radius,face,u,v,"
         "light.s,light.t");
    for (size_t i = 0; i < n; i++) {
        const struct pick *pick = &picks[i];
        bool is_there = has_surface(pick);
        printf("%.17g,%.17g", pick->x, pick->y);
        for (int k = 0; k < 3; k++)
            print_field((double)pick->point[k]);
        for (int k = 0; k < 3; k++)
            print_field((double)pick->normal[k]);
        for (int k = 0; k < 2; k++)
            print_field((double)pick->curvature[k]);
        print_field(radius(pick));
        print_field(is_there ? pick->face : NAN);
        for (int k = 0; k < 2; k++)
            print_field(is_there ? (double)pick->uv[k] : (double)NAN);
        for (int k = 0; k < 2; k++)
            print_field((double)pick->light[k]);
        putchar('\n');
    }
}

static void json_floats(struct json *json, const char *key, const float *value, size_t n)
{
    json_array_begin(json, key);
    for (size_t i = 0; i < n; i++)
        json_double(json, NULL, (double)value[i]);
    json_array_end(json);
}

void pick_json(struct json *json, const struct pick *pick)
{
    json_double(json, "x", pick->x);
    json_double(json, "y", pick->y);
    json_bool(json, "hit", has_surface(pick));
    if (!has_surface(pick))
        return;
    json_floats(json, "point", pick->point, 3);
    if (!isnan(pick->normal[0])) {
        json_floats(json, "normal", pick->normal, 3);
        json_double(json, "k_min", (double)pick->curvature[0]);
        json_double(json, "k_max", (double)pick->curvature[1]);
        json_double(json, "mean", mean(pick));
        json_double(json, "gaussian", gaussian(pick));
        json_double(json, "radius", radius(pick));
    }
    json_uint(json, "face", pick->face);
    json_floats(json, "uv", pick->uv, 2);
    if (!isnan(pick->light[0]))
        json_floats(json, "light_st", pick->light, 2);
}
