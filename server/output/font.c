#include "server/output/font.h"

#include <stdlib.h>
#include <string.h>

/* A glyph's strokes, separated by '|': points `x,y` in the units of font.h, joined by lines, or, after
 * 'c', the control points of a curve. */
struct glyph {
    char character;
    int width; /* x of the rightmost point */
    const char *strokes;
};

#define ROUND "c1,1 9,1 9,12 1,12 1,1" /* of the letter o and its kin */

static const struct glyph glyphs[] = {
    {' ', 3, ""},
    {'(', 5, "c5,18 1,14 1,2 5,-2"},
    {')', 5, "c1,18 5,14 5,2 1,-2"},
    {'+', 11, "1,8 11,8|6,3 6,13"},
    {',', 2, "2,1 1,-2"},
    {'-', 6, "1,7 6,7"},
    {'.', 1, "1,1 1,1"},
    {'/', 6, "0,-1 6,17"},
    {'0', 9, "c1,9 1,17 9,17 9,1 1,1 1,9"},
    {'1', 9, "1,14 5,17 5,1|1,1 9,1"},
    {'2', 9, "c1,14 1,17 9,17 9,10 1,1|1,1 9,1"},
    {'3', 10, "c1,15 1,17 9,17 9,9 4,9|c4,9 9,9 10,1 1,1 1,3"},
    {'4', 10, "7,1 7,17 1,6 10,6"},
    {'5', 10, "8,17 2,17 2,10|c2,10 10,13 10,1 1,1 1,3"},
    {'6', 9, "c8,16 7,17 1,17 1,6|" ROUND},
    {'7', 9, "1,17 9,17 4,1"},
    {'8', 9, "c2,10 8,10 8,17 2,17 2,10|c1,1 9,1 9,10 1,10 1,1"},
    {'9', 9, "c2,2 3,1 9,1 9,12|c9,17 1,17 1,6 9,6 9,17"},
    {':', 1, "1,1 1,1|1,11 1,11"},
    {'=', 11, "1,6 11,6|1,11 11,11"},
    {'G', 13, "c13,14 13,17 1,17 1,1 11,1 13,3|13,3 13,8 8,8"},
    {'P', 11, "1,1 1,17 6,17|c6,17 11,17 11,8 6,8|6,8 1,8"},
    {'^', 9, "1,12 5,17 9,12"},
    {'a', 9, ROUND "|9,12 9,1"},
    {'b', 9, ROUND "|1,17 1,1"},
    {'c', 8, "c8,11 8,12 1,12 1,1 8,1 8,2"},
    {'d', 9, ROUND "|9,17 9,1"},
    {'e', 9, "1,7 9,7|c9,7 9,12 1,12 1,1 8,1 9,3"},
    {'f', 7, "c7,17 3,17 3,12|3,12 3,1|0,12 7,12"},
    {'g', 9, ROUND "|9,12 9,0|c9,0 9,-4 2,-4 2,-3"},
    {'h', 9, "1,17 1,1|c1,7 1,12 9,12 9,7|9,7 9,1"},
    {'i', 1, "1,12 1,1|1,16 1,16"},
    {'j', 3, "3,12 3,0|c3,0 3,-4 0,-4|3,16 3,16"},
    {'k', 9, "1,17 1,1|8,12 1,6|4,8 9,1"},
    {'l', 1, "1,17 1,1"},
    {'m', 15, "1,12 1,1|c1,7 1,12 8,12 8,7|8,7 8,1|c8,7 8,12 15,12 15,7|15,7 15,1"},
    {'n', 9, "1,12 1,1|c1,7 1,12 9,12 9,7|9,7 9,1"},
    {'o', 9, ROUND},
    {'p', 9, ROUND "|1,12 1,-4"},
    {'q', 9, ROUND "|9,12 9,-4"},
    {'r', 6, "1,12 1,1|c1,6 1,12 6,12"},
    {'s', 8, "c8,10 7,12 1,12 1,7 8,6 8,1 1,1 1,3"},
    {'t', 7, "3,16 3,5|c3,5 3,1 7,1|0,12 7,12"},
    {'u', 9, "1,12 1,6|c1,6 1,1 9,1 9,6|9,12 9,1"},
    {'v', 9, "1,12 5,1 9,12"},
    {'w', 13, "1,12 4,1 7,12 10,1 13,12"},
    {'x', 9, "1,12 9,1|9,12 1,1"},
    {'y', 9, "1,12 5,1|9,12 4,-2|c4,-2 3,-4 1,-4"},
    {'z', 8, "1,12 8,12 1,1 8,1"},
};

/* Instead of a character that the font lacks. */
static const struct glyph box = {0, 9, "1,1 9,1 9,17 1,17 1,1"};

static const struct glyph *find(char character)
{
    for (size_t i = 0; i < sizeof glyphs / sizeof glyphs[0]; i++)
        if (glyphs[i].character == character)
            return &glyphs[i];
    return &box;
}

bool font_has(char character)
{
    return find(character) != &box;
}

int font_width(char character)
{
    return find(character)->width;
}

/* --- strokes to lines */

struct point {
    double x, y;
};

static void add_line(struct font_lines *lines, struct point a, struct point b)
{
    if (lines->n < FONT_MAX_LINES)
        lines->line[lines->n++] = (struct font_line){a.x, a.y, b.x, b.y};
}

static struct point between(struct point a, struct point b, double t)
{
    return (struct point){a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t};
}

/* A parabola from a to c; the lines from both to b are its tangents. */
static void add_parabola(struct font_lines *lines, struct point a, struct point b, struct point c)
{
    enum { PIECES = 8 };
    struct point from = a;
    for (int i = 1; i <= PIECES; i++) {
        const double t = (double)i / PIECES;
        const struct point to = between(between(a, b, t), between(b, c, t), t);
        add_line(lines, from, to);
        from = to;
    }
}

/* A quadratic B-spline: it touches the middle of each side of its control polygon, and begins and ends
 * at the polygon's ends, or is closed where these are the same point. */
static void add_curve(struct font_lines *lines, const struct point *p, int n)
{
    const bool is_closed = p[0].x == p[n - 1].x && p[0].y == p[n - 1].y;
    struct point from = is_closed ? between(p[0], p[1], 0.5) : p[0];
    for (int i = 1; i + 1 < n; i++) {
        const bool is_last = i + 2 == n && !is_closed;
        const struct point to = is_last ? p[n - 1] : between(p[i], p[i + 1], 0.5);
        add_parabola(lines, from, p[i], to);
        from = to;
    }
    if (is_closed)
        add_parabola(lines, from, p[0], between(p[0], p[1], 0.5));
}

static void add_stroke(struct font_lines *lines, const char *text)
{
    enum { MAX_POINTS = 12 };
    const bool is_curve = *text == 'c';
    struct point p[MAX_POINTS] = {{0, 0}};
    int n = 0;
    text += is_curve;
    while (*text && *text != '|' && n < MAX_POINTS) {
        char *end;
        p[n].x = (double)strtol(text, &end, 10);
        p[n++].y = (double)strtol(end + 1, &end, 10); /* after the comma */
        text = end + (*end == ' ');
    }
    if (is_curve)
        add_curve(lines, p, n);
    for (int i = 1; !is_curve && i < n; i++)
        add_line(lines, p[i - 1], p[i]);
}

void font_glyph(char character, struct font_lines *lines)
{
    lines->n = 0;
    for (const char *stroke = find(character)->strokes; stroke && *stroke;
         stroke = strchr(stroke, '|'), stroke = stroke ? stroke + 1 : NULL)
        add_stroke(lines, stroke);
}
