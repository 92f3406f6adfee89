/* Which pieces of the surface are drawn, and how finely, so that no triangle strays more than
 * half a pixel from the surface (limit-surface 3.2). Pure: no GL here.
 *
 * A piece is a square of a node's local coordinates: a part of a REGULAR node, of one patch of a
 * STRIP, of one unit square of a CORNER's level ring, or all that is left of a CORNER below one
 * level. */
#ifndef SHEEN_RENDER_PATCH_GRIDS_H
#define SHEEN_RENDER_PATCH_GRIDS_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/clusters.h"
#include "server/render/view.h"
#include "server/surface/tables.h"

/* Grid g has piece_cells[g / PIECE_SIDES] cells along u and piece_cells[g % PIECE_SIDES] along v.
 */
enum { PIECE_SIDES = 12, PIECE_GRIDS = PIECE_SIDES * PIECE_SIDES };
extern const uint8_t piece_cells[PIECE_SIDES];

/* As shaders/visibility.vert.glsl reads it. */
struct piece {
    uint32_t node;
    uint32_t where; /* level | square << 6 | depth << 8 | grid << 16 */
    uint32_t x, y;  /* which square of the 2^depth by 2^depth ones */
};

/* A place on the surface for Newton's method to begin at, as shaders/walk.glsl reads it. */
struct guess {
    uint32_t node;
    uint32_t where; /* level | s << 6 | t << 19, 13 bits each: shaders/visibility.frag.glsl */
    float depth;    /* along the view axis, units */
};

/* Of one call of pieces_guess(). A car has about 60 behind a pixel. */
enum { MAX_GUESSES = 4096 };

struct pieces {
    /* In the order of their grids: those of grid g from first[g] to first[g + 1]. */
    struct piece *piece;
    size_t first[PIECE_GRIDS + 1];
    struct piece *chosen; /* scratch: in the order of the nodes */
    size_t piece_capacity;
    /* Blocks of COVER_BLOCK_PX x COVER_BLOCK_PX pixels of the tile that the pieces may cover, x |
     * y << 16 in blocks; outside them nothing is seen. */
    uint32_t *block;
    size_t n_blocks;
    uint8_t *is_covered; /* scratch: one byte a block of the tile */
    size_t block_capacity;
    /* What pieces_guess() has found since n_guesses was last made 0. */
    struct guess *guess;
    size_t n_guesses, guess_capacity;
};

/* Chooses the pieces that the tile may show; `clusters` are those of the tables. Lists keep their
 * memory from call to call; zero them before the first. ERROR_REQUEST when the view would need more
 * grid vertices than a frame may take (a surface that is millions of times larger than the picture
 * and runs along the view), ERROR_SERVER when memory is short. */
bool pieces_choose(struct pieces *pieces, const struct limit_tables *tables,
                   const struct clusters *clusters, const struct view *view,
                   const struct tile *tile, struct error *error);
/* Cuts what a tile of a few pixels may show into pieces that one cell each would draw as well as
 * pieces_choose() asks, and adds a guess in the middle of each: one that leads to whatever surface
 * a ray of the tile meets. The pieces and blocks chosen before stay. Adds none where there would be
 * more than MAX_GUESSES: one invocation of a shader tries them one by one, and a file of many
 * sheets behind each other could keep the device for seconds. Fails for want of memory alone. */
bool pieces_guess(struct pieces *pieces, const struct limit_tables *tables,
                  const struct clusters *clusters, const struct view *view, const struct tile *tile,
                  struct error *error);
/* The blocks become those of a larger tile, at so many blocks of it. */
void pieces_move_blocks(struct pieces *pieces, uint32_t x, uint32_t y);
/* Drops the blocks that do not begin inside `part` of that. */
void pieces_cut_blocks(struct pieces *pieces, const struct tile *part);
/* No pieces, and every block of the tile: for what is drawn in another way. */
bool pieces_cover_all(struct pieces *pieces, const struct tile *tile, struct error *error);
void pieces_finish(struct pieces *pieces);

#endif
