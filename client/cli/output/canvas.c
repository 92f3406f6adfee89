#include "client/cli/output/canvas.h"

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/files/file.h"
#include "client/cli/output/glyphs.h"
#include "client/cli/base/failure.h"
#include "protocol/srgb.h"

bool canvas_init(struct canvas *canvas, uint32_t width_px, uint32_t height_px)
{
    size_t bytes = (size_t)3 * width_px * height_px;
    *canvas = (struct canvas){width_px, height_px, malloc(bytes)};
    if (canvas->rgb)
        memset(canvas->rgb, 255, bytes);
    return canvas->rgb != NULL;
}

void canvas_finish(struct canvas *canvas)
{
    free(canvas->rgb);
    *canvas = (struct canvas){0};
}

static uint8_t *pixel_at(struct canvas *canvas, uint32_t x, uint32_t y)
{
    if (x >= canvas->width_px || y >= canvas->height_px)
        return NULL;
    return canvas->rgb + 3 * ((size_t)y * canvas->width_px + x);
}

/* Blends one channel of a pixel over the canvas, in linear light. */
static uint8_t mix(uint8_t top, double share, uint8_t below)
{
    if (share == 1)
        return top;
    double light =
        share * srgb_to_linear(top / 255.0) + (1 - share) * srgb_to_linear(below / 255.0);
    return (uint8_t)lround(255 * srgb_from_linear(light));
}

void canvas_paint(struct canvas *canvas, uint32_t x, uint32_t y, const uint8_t rgb[3], double share)
{
    uint8_t *to = pixel_at(canvas, x, y);
    for (int k = 0; to && k < 3; k++)
        to[k] = mix(rgb[k], share, to[k]);
}

void canvas_picture(struct canvas *canvas, uint32_t x, uint32_t y, const uint8_t (*rgba)[4],
                    uint32_t width_px, uint32_t height_px)
{
    for (uint32_t j = 0; j < height_px; j++)
        for (uint32_t i = 0; i < width_px; i++, rgba++) {
            uint8_t *to = pixel_at(canvas, x + i, y + j);
            for (int k = 0; to && k < 3; k++)
                to[k] = mix((*rgba)[k], (*rgba)[3] / 255.0, to[k]);
        }
}

/* Draws one pixel of a letter, which is a square. */
static void ink(struct canvas *canvas, uint32_t x, uint32_t y, uint32_t x_end, uint32_t size)
{
    for (uint32_t k = 0; k < size * size; k++) {
        uint8_t *to = x + k % size < x_end ? pixel_at(canvas, x + k % size, y + k / size) : NULL;
        if (to)
            memset(to, 0, 3);
    }
}

void canvas_text(struct canvas *canvas, uint32_t x, uint32_t y, uint32_t x_end, uint32_t scale,
                 const char *text)
{
    for (; *text && x < x_end; text++, x += GLYPH_ADVANCE * scale)
        for (int k = 0; k < GLYPH_WIDTH * GLYPH_HEIGHT; k++) {
            int column = k % GLYPH_WIDTH, row = k / GLYPH_WIDTH;
            if (glyph_has(*text, column, row))
                ink(canvas, x + (uint32_t)column * scale, y + (uint32_t)row * scale, x_end, scale);
        }
}

enum sheen_status canvas_png(const struct canvas *canvas, uint8_t **file, size_t *n_bytes,
                             struct sheen_error *error)
{
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = canvas->width_px,
                       .height = canvas->height_px,
                       .format = PNG_FORMAT_RGB};
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image); /* an upper bound for any pixels */
    *file = malloc(bytes);
    if (!*file)
        return failure_set(error, SHEEN_NO_MEMORY, "no memory for a picture of %zu bytes",
                           (size_t)bytes);
    *n_bytes = bytes;
    if (png_image_write_to_memory(&image, *file, n_bytes, 0, canvas->rgb, 0, NULL))
        return SHEEN_OK;
    free(*file);
    *file = NULL;
    return failure_set(error, SHEEN_BAD_IMAGE, "a picture: %s", image.message);
}

enum sheen_status canvas_write_png(const struct canvas *canvas, const char *path,
                                   struct sheen_error *error)
{
    uint8_t *file = NULL;
    size_t n_bytes = 0;
    enum sheen_status status = canvas_png(canvas, &file, &n_bytes, error);
    if (!status)
        status = file_write(path, file, n_bytes, error);
    free(file);
    return status;
}
