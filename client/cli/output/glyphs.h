/* A bitmap font for captions: lower-case letters, digits and punctuation. Any thread. */
#ifndef SHEEN_CLIENT_GLYPHS_H
#define SHEEN_CLIENT_GLYPHS_H

#include <stdbool.h>

enum { GLYPH_WIDTH = 5, GLYPH_HEIGHT = 9, GLYPH_ADVANCE = 6 };

/* True if the glyph of c is black at column x and row y, from its top left. Characters that are not
 * in the font are blank. */
bool glyph_has(char c, int x, int y);

#endif
