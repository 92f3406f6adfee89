/* A bitmap font for the captions of pictures: lower-case letters, digits and what stands between
 * them. Any thread. */
#ifndef SHEEN_CLIENT_GLYPHS_H
#define SHEEN_CLIENT_GLYPHS_H

#include <stdbool.h>

enum { GLYPH_WIDTH = 5, GLYPH_HEIGHT = 9, GLYPH_ADVANCE = 6 };

/* Whether the glyph of c is inked at column x and row y from its top left. A character that is not
 * in the font is blank. */
bool glyph_has(char c, int x, int y);

#endif
