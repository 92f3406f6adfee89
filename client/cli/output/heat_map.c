#include "client/cli/output/heat_map.h"

#include <math.h>
#include <string.h>

enum { POSITION_BIT = 1, NORMAL_BIT = 2 };

/* The colour of a share of the scale: black, blue, red, yellow, white. */
static void scale_colour(double share, uint8_t rgb[3])
{
    static const double stops[5][3] = {
        {0, 0, 0}, {40, 60, 190}, {215, 50, 50}, {250, 200, 40}, {255, 255, 255}};
    double at = fmin(fmax(share, 0), 1) * 4;
    int i = at < 3 ? (int)at : 3;
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)lrint(stops[i][k] + (at - i) * (stops[i + 1][k] - stops[i][k]));
}

static double dot(const float a[3], const float b[3])
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

static double value_at(enum heat_kind kind, const struct sheen_frame *old,
                       const struct sheen_frame *new, size_t pixel)
{
    const float *n = ((const float(*)[3])old->plane[NORMAL_BIT])[pixel];
    const float *m = ((const float(*)[3]) new->plane[NORMAL_BIT])[pixel];
    const float *p = ((const float(*)[3])old->plane[POSITION_BIT])[pixel];
    const float *q = ((const float(*)[3]) new->plane[POSITION_BIT])[pixel];
    if (kind == HEAT_DISTANCE) {
        const float way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        return fabs(dot(way, n));
    }
    const float cross[3] = {n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2],
                            n[0] * m[1] - n[1] * m[0]};
    /* Up to winding, as the comparison. */
    return atan2(sqrt(dot(cross, cross)), fabs(dot(n, m))) * (180 / 3.14159265358979323846);
}

void heat_map_paint(struct canvas *canvas, enum heat_kind kind, const struct sheen_frame *old,
                    const struct sheen_frame *new, double most)
{
    static const uint8_t grey[3] = {0x9a, 0x9a, 0x9a}, magenta[3] = {0xff, 0, 0xff};
    const float(*p)[3] = old->plane[POSITION_BIT], (*q)[3] = new->plane[POSITION_BIT];
    for (size_t i = 0; i < (size_t)canvas->width_px * canvas->height_px; i++) {
        uint8_t *rgb = canvas->rgb + 3 * i;
        bool has_old = !isnan(p[i][0]), has_new = !isnan(q[i][0]);
        double value = has_old && has_new ? value_at(kind, old, new, i) : 0;
        if (has_old && has_new && !isnan(value))
            scale_colour(value / most, rgb);
        else
            memcpy(rgb, has_old == has_new ? grey : magenta, 3);
    }
}

void heat_map_paint_scale(struct canvas *canvas)
{
    for (uint32_t y = 0; y < canvas->height_px; y++)
        for (uint32_t x = 0; x < canvas->width_px; x++)
            scale_colour((x + 0.5) / canvas->width_px,
                         canvas->rgb + 3 * ((size_t)y * canvas->width_px + x));
}
