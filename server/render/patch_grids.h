/* Which parts of the surface are drawn, and by how fine a grid each, so that no triangle strays
 * more than half a pixel from the surface (server/surface/README.md 6.1). Pure: no GL here.
 *
 * A patch grid covers a square of a node's local coordinates: a part of a REGULAR node, of one
 * patch of a STRIP, of one unit square of a CORNER's level ring, or all that is left of a CORNER
 * below one level. Its cells are drawn as two triangles each. */
#ifndef SHEEN_RENDER_PATCH_GRIDS_H
#define SHEEN_RENDER_PATCH_GRIDS_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/clusters.h"
#include "server/render/view.h"
#include "server/surface/tables.h"

/* A grid of shape g has grid_cells[g / GRID_SIDES] cells along u, grid_cells[g % GRID_SIDES] along
 * v. */
enum { GRID_SIDES = 12, GRID_SHAPES = GRID_SIDES * GRID_SIDES };
extern const uint8_t grid_cells[GRID_SIDES];

/* As shaders/visibility.vert.glsl reads it. */
struct patch_grid {
    uint32_t node;
    uint32_t where; /* level | square << 6 | depth << 8 | shape << 16 */
    uint32_t x, y;  /* which of the 2^depth by 2^depth squares */
};

/* A place on the surface for Newton's method to begin at, as shaders/walk.glsl reads it. */
struct guess {
    uint32_t node;
    uint32_t where; /* level | s << 6 | t << 19, 13 bits each: shaders/visibility.frag.glsl */
    float depth;    /* along the view axis, units */
};

/* Of one call of patch_grids_guess(). A car has about 60 behind a pixel. */
enum { MAX_GUESSES = 4096 };

struct patch_grids {
    /* In the order of their shapes: those of shape g from first[g] to first[g + 1]. */
    struct patch_grid *grid;
    size_t first[GRID_SHAPES + 1];
    struct patch_grid *chosen; /* in the order of the nodes */
    size_t n_chosen;
    size_t capacity;
    /* Blocks of COVER_BLOCK_PX x COVER_BLOCK_PX pixels of the tile that the grids may cover, x |
     * y << 16 in blocks; outside of the blocks nothing is seen. */
    uint32_t *block;
    size_t n_blocks;
    uint8_t *is_covered; /* scratch: one byte a block of the tile */
    size_t block_capacity;
    /* What patch_grids_guess() has found since n_guesses was last made 0. */
    struct guess *guess;
    size_t n_guesses, guess_capacity;
};

/* Chooses all that the tile may show; `clusters` are those of the tables. Lists keep their memory
 * from call to call; zero them before the first. ERROR_REQUEST when the view would need more grid
 * vertices than a frame may take (a surface that is millions of times larger than the picture and
 * runs along the view), ERROR_SERVER when memory is short. */
bool patch_grids_choose(struct patch_grids *grids, const struct limit_tables *tables,
                        const struct clusters *clusters, const struct view *view,
                        const struct tile *tile, struct error *error);
/* Chooses what clusters [first, first + n) may show, as `chosen`: neither in the order of shapes nor
 * with blocks. Adds to *n_vertices how many of GRIDS_MAX_VERTICES that takes; beyond that it stops.
 * Fails when memory is short, and for no other reason. */
bool patch_grids_choose_part(struct patch_grids *grids, const struct limit_tables *tables,
                             const struct clusters *clusters, size_t first, size_t n,
                             const struct view *view, const struct tile *tile, uint64_t *n_vertices,
                             struct error *error);
/* Grid vertices of a tile: what a software device draws in a few seconds, and many times what a
 * million faces need. */
#define GRIDS_MAX_VERTICES 24000000u
/* The error of a view that takes more. */
bool patch_grids_too_many(struct error *error);
/* Cuts what a tile of a few pixels may show so finely that grids of one cell would draw it as well
 * as patch_grids_choose() asks, and adds a guess in the middle of each part: one that leads to
 * whatever surface a ray of the tile meets. The grids and blocks chosen before stay. Adds none
 * where there would be more than MAX_GUESSES: one invocation of a shader tries them one by one, and
 * a file of many sheets behind each other could keep the device for seconds. Fails when memory is
 * short, and for no other reason. */
bool patch_grids_guess(struct patch_grids *grids, const struct limit_tables *tables,
                       const struct clusters *clusters, const struct view *view,
                       const struct tile *tile, struct error *error);
/* Makes the blocks those of a larger tile, in which the tile of the call before begins at block
 * (x, y). */
void patch_grids_move_blocks(struct patch_grids *grids, uint32_t x, uint32_t y);
/* Drops the blocks that do not begin inside `part` of that larger tile, px. */
void patch_grids_cut_blocks(struct patch_grids *grids, const struct tile *part);
/* No grids, and every block of the tile: for what is drawn in another way. ERROR_SERVER when memory
 * is short. */
bool patch_grids_cover_all(struct patch_grids *grids, const struct tile *tile, struct error *error);
void patch_grids_finish(struct patch_grids *grids);

#endif
