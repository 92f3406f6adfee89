#include "server/surface/subdivision/strip.h"

#include <string.h>

#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/settle.h"
#include "server/surface/topology/sharpness.h"

/* The sharpness of the crease that goes straight through a regular vertex along the quad's edge 0
 * or 1; 0 if there is none. */
static float straight_crease(const struct ring *ring, int edge)
{
    if (!ring->closed || ring->n_faces != 4 || !ring->creases.edge || ring->sharpness > 0 ||
        ring->sheets.creases)
        return 0;
    float sharpness = crease_edge(ring, ring_edge_index(ring, edge));
    bool straight = crease_edge(ring, ring_edge_index(ring, edge + 2)) == sharpness &&
                    crease_edge(ring, ring_edge_index(ring, edge + 1)) <= 0 &&
                    crease_edge(ring, ring_edge_index(ring, edge + 3)) <= 0;
    return straight ? sharpness : 0;
}

unsigned strip_levels(const struct quad *quad, unsigned *edge)
{
    for (unsigned e = 0; e < 4; e++) {
        const struct ring *start = &quad->corner[e], *end = &quad->corner[(e + 1) & 3];
        float sharpness = straight_crease(start, 0);
        if (sharpness <= 0 || straight_crease(end, 1) != sharpness)
            continue;
        if (!ring_is_regular(&quad->corner[(e + 2) & 3]) ||
            !ring_is_regular(&quad->corner[(e + 3) & 3]))
            continue;
        *edge = e;
        unsigned levels = 0;
        for (; sharpness > 0; sharpness = sharpness_child(sharpness))
            levels++;
        return levels;
    }
    return 0;
}

/* One step across the crease: rows -1..2 become rows -1..3 of the finer net. */
static void refine_rows(struct vec rows[4][4], double crease, struct vec fine[5][4])
{
    for (int i = 0; i < 4; i++) {
        struct vec below = rows[0][i], at = rows[1][i], above = rows[2][i], next = rows[3][i];
        struct vec smooth = vec_mad(vec_scale(at, 0.75), 0.125, vec_add(below, above));
        fine[0][i] = vec_scale(vec_add(below, at), 0.5);
        fine[1][i] = vec_mad(vec_scale(smooth, 1 - crease), crease, at);
        fine[2][i] = vec_scale(vec_add(at, above), 0.5);
        fine[3][i] = vec_mad(vec_scale(above, 0.75), 0.125, vec_add(at, next));
        fine[4][i] = vec_scale(vec_add(above, next), 0.5);
    }
}

void strip_points(const struct quad *quad, unsigned levels, struct vec whole[16],
                  struct vec (*patch)[16], double origin[3])
{
    struct vec rows[4][4], fine[5][4], centre = {0, 0, 0};
    quad_grid(quad, rows);
    for (int k = 0; k < 16; k++)
        centre = vec_mad(centre, 1.0 / 16, rows[k / 4][k % 4]);
    for (int k = 0; k < 16; k++)
        rows[k / 4][k % 4] = vec_sub(rows[k / 4][k % 4], centre);
    memcpy(whole, rows, sizeof rows);
    float sharpness = straight_crease(&quad->corner[0], 0);
    for (unsigned n = 0; n < levels; n++) {
        refine_rows(rows, sharpness < 1 ? (double)sharpness : 1, fine);
        memcpy(patch[n], fine[1], sizeof patch[n]);
        sharpness = sharpness_child(sharpness);
        memcpy(rows, fine, sizeof rows);
    }
    memcpy(patch[levels], rows, sizeof rows);
    origin[0] = centre.x;
    origin[1] = centre.y;
    origin[2] = centre.z;
}
