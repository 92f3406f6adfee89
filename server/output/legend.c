#include "server/output/legend.h"

#include <math.h>
#include <string.h>

#include "server/image/blend.h"
#include "server/output/text.h"

/* Lengths in units of the font's size, which is 1/45 of the picture's height. */
#define FONT_SHARE 45
#define MIN_FONT_PX 8
#define PANEL_WIDTH 19
#define PANEL_HEIGHT 5.2
#define MARGIN 0.8
#define TITLE_BASELINE 1.5
#define BAR_TOP 2.1
#define BAR_HEIGHT 1.1
#define MARKS_BASELINE 4.5

static const float TEXT_COLOUR[4] = {1, 1, 1, 1};
static const float PANEL_SHARE = 0.68f; /* of black */

struct box {
    int x, y, width, height; /* pixels, inside of the picture */
};

static uint8_t *pixel_at(uint8_t *rgba, uint32_t width_px, int x, int y)
{
    return rgba + 4 * ((size_t)y * width_px + (size_t)x);
}

static void darken(uint8_t *rgba, uint32_t width_px, const struct box *box)
{
    static const float black[4] = {0, 0, 0, 1};
    uint8_t before[4] = {0}, after[4] = {0}; /* most pixels equal the previous one */
    blend_pixel(after, black, PANEL_SHARE);
    for (int y = box->y; y < box->y + box->height; y++)
        for (int x = box->x; x < box->x + box->width; x++) {
            uint8_t *pixel = pixel_at(rgba, width_px, x, y);
            if (memcmp(pixel, before, sizeof before) != 0) {
                memcpy(before, pixel, sizeof before);
                memcpy(after, pixel, sizeof after);
                blend_pixel(after, black, PANEL_SHARE);
            }
            memcpy(pixel, after, sizeof after);
        }
}

static void draw_bar(uint8_t *rgba, uint32_t width_px, const struct box *box,
                     const struct legend *legend)
{
    for (int y = 0; y < box->height; y++)
        for (int x = 0; x < box->width; x++) {
            float rgb[3];
            legend->colour(legend->context, (x + 0.5) / box->width, 1 - (y + 0.5) / box->height,
                           rgb);
            uint8_t *pixel = pixel_at(rgba, width_px, box->x + x, box->y + y);
            for (int k = 0; k < 3; k++)
                pixel[k] = (uint8_t)lroundf(rgb[k] * 255);
            pixel[3] = 255;
        }
}

static void write_texts(uint8_t *rgba, uint32_t width_px, uint32_t height_px, const struct box *bar,
                        int panel_y, int font, const struct legend *legend)
{
    text_draw(legend->title, font, rgba, width_px, height_px, bar->x,
              panel_y + (int)(TITLE_BASELINE * font), TEXT_LEFT, TEXT_COLOUR);
    for (unsigned i = 0; i < legend->n_marks; i++) {
        const struct legend_mark *mark = &legend->marks[i];
        enum text_align align = mark->at <= 0   ? TEXT_LEFT
                                : mark->at >= 1 ? TEXT_RIGHT
                                                : TEXT_CENTRE;
        text_draw(mark->text, font, rgba, width_px, height_px,
                  bar->x + (int)(mark->at * bar->width), panel_y + (int)(MARKS_BASELINE * font),
                  align, TEXT_COLOUR);
    }
}

void legend_draw(uint8_t *rgba, uint32_t width_px, uint32_t height_px, const struct legend *legend)
{
    int font = (int)(height_px / FONT_SHARE);
    font = font < MIN_FONT_PX ? MIN_FONT_PX : font;
    struct box panel = {.width = PANEL_WIDTH * font, .height = (int)(PANEL_HEIGHT * font)};
    if (height_px < LEGEND_MIN_HEIGHT_PX || width_px < (uint32_t)panel.width)
        return;
    panel.x = (int)width_px - panel.width;
    panel.y = (int)height_px - panel.height;
    int margin = (int)(MARGIN * font);
    const struct box bar = {panel.x + margin, panel.y + (int)(BAR_TOP * font),
                            panel.width - 2 * margin, (int)(BAR_HEIGHT * font)};
    darken(rgba, width_px, &panel);
    draw_bar(rgba, width_px, &bar, legend);
    write_texts(rgba, width_px, height_px, &bar, panel.y, font, legend);
}
