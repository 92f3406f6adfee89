/* Chooses the parts of the surface that a tile may show, and for each the grid with which it is
 * drawn, so that no triangle is more than half a pixel from the surface (server/surface/README.md
 * 6.1). Contains no GL.
 *
 * A patch grid covers a square of a node's local coordinates: a part of a REGULAR node, of one
 * patch of a STRIP, of one unit square of a CORNER's level ring, or the rest of a CORNER below one
 * level. Each of its cells is drawn as two triangles. Any thread, one at a time for each struct
 * patch_grids. */
#ifndef SHEEN_RENDER_PATCH_GRIDS_H
#define SHEEN_RENDER_PATCH_GRIDS_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/clusters.h"
#include "server/render/view.h"
#include "server/surface/tables.h"

/* A grid of shape g has grid_cells[g / GRID_SIDES] cells along u and grid_cells[g % GRID_SIDES]
 * along v. */
enum { GRID_SIDES = 12, GRID_SHAPES = GRID_SIDES * GRID_SIDES };
extern const uint8_t grid_cells[GRID_SIDES];

/* Read by shaders/visibility.vert.glsl. */
struct patch_grid {
    uint32_t node;
    uint32_t where; /* level | square << 6 | depth << 8 | shape << 16 */
    uint32_t x, y;  /* the square in a grid of 2^depth by 2^depth */
};

/* A start for Newton's method: a place on the surface. Read by shaders/walk.glsl. */
struct guess {
    uint32_t node;
    uint32_t where; /* level | s << 6 | t << 19, 13 bits each: shaders/visibility.frag.glsl */
    float depth;    /* along the view axis, units */
};

/* The largest number of guesses of one call of patch_grids_guess(). A car has about 60 at a
 * pixel. */
enum { MAX_GUESSES = 4096 };

struct patch_grids {
    /* Sorted by shape: the grids of shape g are first[g] to first[g + 1] - 1. */
    struct patch_grid *grid;
    size_t first[GRID_SHAPES + 1];
    struct patch_grid *chosen; /* sorted by node */
    size_t n_chosen;
    size_t capacity;
    /* Blocks of COVER_BLOCK_PX x COVER_BLOCK_PX pixels of the tile that the grids may cover, as x |
     * y << 16 in blocks; outside of them no surface is visible. */
    uint32_t *block;
    size_t n_blocks;
    uint8_t *is_covered; /* scratch memory, one byte for each block of the tile */
    size_t block_capacity;
    /* The guesses found since n_guesses was set to 0. */
    struct guess *guess;
    size_t n_guesses, guess_capacity;
};

/* Chooses everything that the tile may show; `clusters` are those of the tables. Lists keep their
 * memory between calls; zero the struct before the first. False with ERROR_REQUEST if the view
 * would need more grid vertices than a frame may have (a surface millions of times larger than the
 * picture, seen along itself), or with ERROR_SERVER when memory is short. */
bool patch_grids_choose(struct patch_grids *grids, const struct limit_tables *tables,
                        const struct clusters *clusters, const struct view *view,
                        const struct tile *tile, struct error *error);
/* Chooses what clusters first to first + n - 1 may show into `chosen`, without sorting and without
 * blocks. Adds the vertices to *n_vertices and stops beyond GRIDS_MAX_VERTICES. Fails only when
 * memory is short. */
bool patch_grids_choose_part(struct patch_grids *grids, const struct limit_tables *tables,
                             const struct clusters *clusters, size_t first, size_t n,
                             const struct view *view, const struct tile *tile, uint64_t *n_vertices,
                             struct error *error);
/* Grid vertices of a tile: what a software device draws in a few seconds, and many times what a
 * million faces need. */
#define GRIDS_MAX_VERTICES 24000000u
/* Sets the error for a view that needs more vertices. Returns false. */
bool patch_grids_too_many(struct error *error);
/* Cuts what a small tile may show so finely that one cell for each part would be as good as the
 * grids of patch_grids_choose(), and adds a guess in the middle of each part. From these guesses
 * every surface that a ray of the tile meets is found. Grids and blocks are unchanged. Adds none if
 * there would be more than MAX_GUESSES: one invocation of a shader tries them one by one, and a
 * file with many sheets behind each other could occupy the device for seconds. Fails only when
 * memory is short. */
bool patch_grids_guess(struct patch_grids *grids, const struct limit_tables *tables,
                       const struct clusters *clusters, const struct view *view,
                       const struct tile *tile, struct error *error);
/* Converts the blocks to those of a larger tile, in which the tile of the last call begins at block
 * (x, y). */
void patch_grids_move_blocks(struct patch_grids *grids, uint32_t x, uint32_t y);
/* Drops blocks that do not begin inside `part` (px) of that larger tile. */
void patch_grids_cut_blocks(struct patch_grids *grids, const struct tile *part);
/* Chooses no grids and every block of the tile, for tiles that are drawn in another way. False with
 * ERROR_SERVER when memory is short. */
bool patch_grids_cover_all(struct patch_grids *grids, const struct tile *tile, struct error *error);
void patch_grids_finish(struct patch_grids *grids);

#endif
