/* The font of legends: strokes of a round pen, made for sheen. So the daemon draws text by itself,
 * needs no font of the machine, and its pictures look the same everywhere. It has small letters,
 * digits and what else legends contain; a character that it lacks is shown as a box.
 *
 * Lengths are in units: the pen is 2 wide; capital letters reach from 0 to 18, small letters from 0 to
 * 13. The baseline is y = 0; y points up. Pure; any thread. */
#ifndef SHEEN_OUTPUT_FONT_H
#define SHEEN_OUTPUT_FONT_H

#include <stdbool.h>

#define FONT_PEN 1.0     /* half of the pen's width */
#define FONT_ASCENT 19.0 /* no stroke's edge is higher */
#define FONT_DESCENT 5.0 /* or further below the baseline */
#define FONT_SPACE 4     /* between the points of two characters */
#define FONT_UNITS 24.66 /* units of the font's size: capital letters are 0.73 of it high */

enum { FONT_MAX_LINES = 96 };
struct font_line {
    double x0, y0, x1, y1;
};
struct font_lines {
    int n;
    struct font_line line[FONT_MAX_LINES];
};

bool font_has(char character);
/* The x of the rightmost point of its strokes; the leftmost is at 0 or 1. */
int font_width(char character);
/* The lines along which the pen draws the character. */
void font_glyph(char character, struct font_lines *lines);

#endif
