#include "server/output/text.h"

#include <math.h>
#include <stddef.h>

#include "server/image/blend.h"
#include "server/output/font.h"

double text_width_px(const char *line, int size_px)
{
    int units = 0;
    for (const char *at = line; *at; at++)
        units += font_width(*at) + (at > line ? FONT_SPACE : 0);
    return (units + FONT_PEN) * (size_px / FONT_UNITS);
}

/* The distance of a point from a line of finite length. */
static double distance(const struct font_line *line, double x, double y)
{
    const double along[2] = {line->x1 - line->x0, line->y1 - line->y0};
    const double length2 = along[0] * along[0] + along[1] * along[1];
    double t = 0;
    if (length2 > 0)
        t = ((x - line->x0) * along[0] + (y - line->y0) * along[1]) / length2;
    t = fmin(1, fmax(0, t));
    return hypot(x - line->x0 - t * along[0], y - line->y0 - t * along[1]);
}

/* A picture, and where a character's origin lies in it. */
struct canvas {
    uint8_t *rgba;
    uint32_t width_px, height_px;
    double x, y;  /* pixels */
    double scale; /* pixels of a unit */
    const float *colour;
};

/* A pixel's number along one axis, within 0 to n. */
static int64_t bounded(double at, uint32_t n)
{
    return (int64_t)fmin(n, fmax(0, at));
}

static void draw_pixel(const struct canvas *canvas, const struct font_lines *lines, int64_t x,
                       int64_t y)
{
    const double units[2] = {((double)x + 0.5 - canvas->x) / canvas->scale,
                             (canvas->y - (double)y - 0.5) / canvas->scale};
    double nearest = INFINITY;
    for (int i = 0; i < lines->n; i++)
        nearest = fmin(nearest, distance(&lines->line[i], units[0], units[1]));
    const double share = (FONT_PEN - nearest) * canvas->scale + 0.5; /* of the pixel's width */
    if (share > 0)
        blend_pixel(canvas->rgba + 4 * (size_t)(y * canvas->width_px + x), canvas->colour,
                    (float)fmin(1, share));
}

static void draw_character(const struct canvas *canvas, char character)
{
    struct font_lines lines;
    font_glyph(character, &lines);
    const double left = canvas->x - (FONT_PEN * canvas->scale + 1);
    const double right = canvas->x + (font_width(character) + FONT_PEN) * canvas->scale + 1;
    const double top = canvas->y - FONT_ASCENT * canvas->scale - 1;
    const double bottom = canvas->y + FONT_DESCENT * canvas->scale + 1;
    for (int64_t y = bounded(top, canvas->height_px); y < bounded(bottom, canvas->height_px); y++)
        for (int64_t x = bounded(left, canvas->width_px); x < bounded(right, canvas->width_px); x++)
            draw_pixel(canvas, &lines, x, y);
}

void text_draw(const char *line, int size_px, uint8_t *rgba, uint32_t width_px, uint32_t height_px,
               int x_px, int y_px, enum text_align align, const float colour[4])
{
    const double width = text_width_px(line, size_px);
    struct canvas canvas = {.rgba = rgba,
                            .width_px = width_px,
                            .height_px = height_px,
                            .x = x_px - (align == TEXT_LEFT    ? 0
                                         : align == TEXT_RIGHT ? width
                                                               : width / 2),
                            .y = y_px,
                            .scale = size_px / FONT_UNITS,
                            .colour = colour};
    for (; *line; line++) {
        draw_character(&canvas, *line);
        canvas.x += (font_width(*line) + FONT_SPACE) * canvas.scale;
    }
}
