/* Text in pictures: where it is drawn, and which characters it has. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/output/font.h"
#include "server/output/text.h"

enum { WIDTH = 67, HEIGHT = 131 };

/* The bounding box of the pixels that text has changed; false if there are none. */
static bool touched(uint8_t (*rgba)[4], int box[4])
{
    bool any = false;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            if (rgba[y * WIDTH + x][3]) {
                box[0] = any && box[0] < x ? box[0] : x;
                box[1] = any && box[1] > x ? box[1] : x;
                box[2] = any ? box[2] : y;
                box[3] = y;
                any = true;
            }
    return any;
}

/* "P0" begins, has its middle or ends at a point. */
static void test_places(void **state)
{
    (void)state;
    static const float orange[4] = {1, 0.5f, 0, 1};
    static uint8_t rgba[HEIGHT * WIDTH][4];
    int box[4];
    const struct {
        enum text_align align;
        int low, high; /* first and last column of the text, relative to the given point */
    } cases[] = {{TEXT_LEFT, 0, 20}, {TEXT_CENTRE, -10, 10}, {TEXT_RIGHT, -20, 0}};
    for (int i = 0; i < 3; i++) {
        memset(rgba, 0, sizeof rgba);
        text_draw("P0", 20, rgba[0], WIDTH, HEIGHT, 33, 60, cases[i].align, orange);
        assert_true(touched(rgba, box));
        assert_in_range(box[0], 33 + cases[i].low - 1, 33 + cases[i].low + 2);
        assert_in_range(box[1], 33 + cases[i].high - 3, 33 + cases[i].high);
        assert_in_range(box[2], 43, 47); /* capital letters are 0.73 of the size high */
        assert_in_range(box[3], 58, 60);
    }
    /* Pixels that text covers wholly have its colour; so has a half-covered pixel that was
     * transparent. */
    bool solid = false;
    for (int i = 0; i < HEIGHT * WIDTH; i++)
        if (rgba[i][3]) {
            assert_int_equal(rgba[i][0], 255);
            assert_in_range(rgba[i][1], 127, 128);
            assert_int_equal(rgba[i][2], 0);
            solid |= rgba[i][3] == 255;
        }
    assert_true(solid);
    /* Text across the picture's border, and far outside. */
    for (int at = -40; at < 200; at += 7)
        text_draw("P0", 20, rgba[0], WIDTH, HEIGHT, at, at, TEXT_CENTRE, orange);
    memset(rgba, 0, sizeof rgba);
    text_draw("P0", 20, rgba[0], WIDTH, HEIGHT, 10, 5000, TEXT_LEFT, orange);
    text_draw("P0", 20, rgba[0], WIDTH, HEIGHT, -5000, 60, TEXT_LEFT, orange);
    text_draw("P0", 20, rgba[0], WIDTH, HEIGHT, INT_MAX, INT_MIN, TEXT_LEFT, orange);
    assert_false(touched(rgba, box));
}

/* Every number that printf() writes, and the letters and marks of legends. A character that is missing
 * is a box, as wide as it is counted. */
static void test_characters(void **state)
{
    (void)state;
    static const char all[] = "0123456789-+.e inf nan abcdefghijklmnopqrstuvwxyz GP ,:/^=()";
    for (const char *at = all; *at; at++)
        assert_true(font_has(*at));
    assert_false(font_has('@'));
    assert_false(font_has('\n'));
    assert_false(font_has((char)0xc3));
    struct font_lines box;
    font_glyph('@', &box);
    assert_int_equal(box.n, 4);
}

/* No line leaves the bounds that the header gives, no list of lines is full, and no two characters
 * but the space look the same. */
static void test_glyphs(void **state)
{
    (void)state;
    static struct font_lines lines[128];
    for (int c = 32; c < 127; c++) {
        font_glyph((char)c, &lines[c]);
        if (!font_has((char)c))
            continue;
        assert_true(lines[c].n < FONT_MAX_LINES && (lines[c].n > 0) == (c != ' '));
        for (int i = 0; i < lines[c].n; i++) {
            const struct font_line *line = &lines[c].line[i];
            assert_true(fmin(line->x0, line->x1) >= 0);
            if (fmax(line->x0, line->x1) > font_width((char)c))
                fail_msg("%c is wider", c);
            assert_true(fmin(line->y0, line->y1) >= FONT_PEN - FONT_DESCENT);
            assert_true(fmax(line->y0, line->y1) <= FONT_ASCENT - FONT_PEN);
        }
        for (int other = 32; other < c; other++)
            assert_true(!font_has((char)other) || lines[other].n != lines[c].n ||
                        memcmp(lines[other].line, lines[c].line,
                               sizeof lines[c].line[0] * (size_t)lines[c].n) != 0);
    }
    assert_true(fabs(text_width_px("10", 20) - (9 + FONT_SPACE + 9 + FONT_PEN) * 20 / FONT_UNITS) <
                1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_characters),
        cmocka_unit_test(test_glyphs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
