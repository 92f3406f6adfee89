#include "client/cli/output/breaks_picture.h"

#include <math.h>
#include <stdlib.h>

enum { N_COLOURS = 3, COLOUR_PLANE = 0, PTEX_PLANE = 3 };
static const uint8_t COLOURS[N_COLOURS][3] = {{230, 0, 230}, {255, 0, 0}, {255, 140, 0}};
static const double HALF_WIDTH_PX = 2;

/* A side of an edge that is out of tolerance. */
struct side {
    uint32_t face, edge;
    uint32_t index; /* of the edge in the list of breaks */
    int colour;
};

/* A pixel of the Ptex plane. */
struct ptex {
    uint32_t face;
    float u, v;
};
_Static_assert(sizeof(struct ptex) == 12, "a pixel of the plane");

static int by_face(const void *a, const void *b)
{
    const struct side *p = a, *q = b;
    return p->face < q->face ? -1 : p->face > q->face;
}

static int colour_of(uint32_t over)
{
    return over >> SHEEN_BREAK_GAP & 1 ? 0 : over >> SHEEN_BREAK_ANGLE & 1 ? 1 : 2;
}

/* The sides of all edges that are out, sorted by face; malloc'd. */
static struct side *list_sides(const struct sheen_breaks *breaks)
{
    struct side *sides = malloc((2 * (size_t)breaks->n_out + 1) * sizeof(*sides));
    for (uint32_t i = 0; sides && i < breaks->n_out; i++)
        for (int k = 0; k < 2; k++)
            sides[2 * (size_t)i + (size_t)k] =
                (struct side){breaks->edges[i].faces[k], breaks->edges[i].edges[k], i,
                              colour_of(breaks->edges[i].over)};
    if (sides)
        qsort(sides, 2 * (size_t)breaks->n_out, sizeof(*sides), by_face);
    return sides;
}

/* The first side of a face; n if there is none. */
static size_t first_side(const struct side *sides, size_t n, uint32_t face)
{
    size_t low = 0, high = n;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (sides[middle].face < face)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* How far a place of a face is from its edge, in the face's parameters. */
static double inside(const struct ptex *at, uint32_t edge)
{
    const double distances[4] = {(double)at->v, 1 - (double)at->u, 1 - (double)at->v,
                                 (double)at->u};
    return distances[edge & 3];
}

/* The change of inside() to the next pixel along x or y that shows the same face; 0: there is none. */
static double slope(const struct ptex *plane, uint32_t width, uint32_t height, uint32_t x,
                    uint32_t y, bool along_y, uint32_t edge)
{
    const struct ptex *at = &plane[(size_t)y * width + x];
    const size_t step = along_y ? width : 1;
    bool has_next = along_y ? y + 1 < height : x + 1 < width, has_last = along_y ? y > 0 : x > 0;
    if (has_next && at[step].face == at->face)
        return inside(at + step, edge) - inside(at, edge);
    if (has_last && (at - step)->face == at->face)
        return inside(at, edge) - inside(at - step, edge);
    return 0;
}

/* True if the side reaches this pixel. */
static bool paint_pixel(struct canvas *canvas, const struct ptex *plane, uint32_t x, uint32_t y,
                        const struct side *side)
{
    const uint32_t width = canvas->width_px, height = canvas->height_px;
    double change = hypot(slope(plane, width, height, x, y, false, side->edge),
                          slope(plane, width, height, x, y, true, side->edge));
    double distance_px =
        change > 0 ? inside(&plane[(size_t)y * width + x], side->edge) / change : 0;
    double share = fmin(HALF_WIDTH_PX + 0.5 - distance_px, 1);
    if (share > 0)
        canvas_paint(canvas, x, y, COLOURS[side->colour], share);
    return share > 0;
}

bool breaks_picture(struct canvas *canvas, const struct sheen_frame *frame,
                    const struct sheen_breaks *breaks, uint32_t *n_hidden)
{
    const struct ptex *plane = frame->plane[PTEX_PLANE];
    struct side *sides = list_sides(breaks);
    const size_t n = 2 * (size_t)breaks->n_out;
    bool *seen = calloc((size_t)breaks->n_out + 1, sizeof(*seen));
    bool ok = canvas_init(canvas, frame->width_px, frame->height_px) && sides && seen;
    if (ok)
        canvas_picture(canvas, 0, 0, (const uint8_t(*)[4])frame->plane[COLOUR_PLANE],
                       frame->width_px, frame->height_px);
    for (uint32_t y = 0; ok && y < frame->height_px; y++)
        for (uint32_t x = 0; x < frame->width_px; x++) {
            const uint32_t face = plane[(size_t)y * frame->width_px + x].face;
            for (size_t i = first_side(sides, n, face); i < n && sides[i].face == face; i++)
                if (paint_pixel(canvas, plane, x, y, &sides[i]))
                    seen[sides[i].index] = true;
        }
    *n_hidden = 0;
    for (uint32_t i = 0; ok && i < breaks->n_out; i++)
        *n_hidden += !seen[i];
    free(seen);
    free(sides);
    return ok;
}
