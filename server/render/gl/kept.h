/* Which planes a frame is drawn into, and when a later frame of the same view may take them instead
 * of drawing. GL thread. */
#ifndef SHEEN_RENDER_GL_KEPT_H
#define SHEEN_RENDER_GL_KEPT_H

#include "server/render/gl/target.h"

struct gl_frame;
struct gl_model;
struct gl_renderer;

/* What the planes of a target hold, so that a frame of the same view needs stage 3 alone. */
struct kept {
    uint64_t model_serial; /* 0: nothing */
    uint32_t width_px, height_px;
    struct camera camera;
    struct surface surface;
    bool ptex, edges;
    bool any_cut; /* the planes are the same, bit by bit, for any cut into tiles, so they serve
                    frames of any cut */
};

/* A target, and which view its planes hold. */
struct planes {
    struct target target;
    struct kept kept;
};

/* Which planes a frame is drawn into: there are several, so that a frame of one kind does not
 * overwrite planes that are kept for another. */
enum planes_of {
    PLANES_WHOLE, /* hold the last frame that was one tile; kept */
    PLANES_SMALL, /* the last such frame of few pixels, which must not overwrite the planes of a
                     larger view; kept */
    PLANES_TILED, /* the last frame of several tiles in_place: the target stands for the whole
                     picture, and each tile fills its part; kept if no other such frame came in
                     between */
    PLANES_APART, /* one tile of a frame in tiles that are not in_place, never kept; and the lists
                     of a tile in_place until they are collected */
    PLANES_KINDS
};

/* How far a frame in tiles in_place has come with its lists: each tile has lists of its own, which
 * are appended to those of the whole picture, and stage 3 of a later frame runs over these. */
enum { COLLECTED_LISTS = 4 };
struct collecting {
    uint64_t frame; /* gl_frame.serial of the frame whose tiles have all been collected so far;
                       0: there is none, or it was given up */
    GLuint n[COLLECTED_LISTS]; /* entries of each list so far */
};

/* Do the planes hold all that stages 1 and 2 would draw for this request? */
bool is_kept(const struct kept *kept, const struct gl_model *model,
             const struct frame_request *request);
/* The planes in use change places with others. */
void planes_swap(struct gl_renderer *r, struct planes *others);
/* Takes into use the planes that a frame's next tile is drawn into. At the first tile of a frame
 * whose view some planes hold already, these are taken, and own->tile is set to the frame's size:
 * it has only stage 3 left, in one tile. */
void planes_choose(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own);
/* Before a tile is drawn into PLANES_TILED: what they hold is lost, unless it is the frame's own.
 */
void collect_begin(struct gl_renderer *r, const struct gl_frame *own);
/* After a tile: the lists of PLANES_APART join those of the tiles before, those at edges too. */
void collect_tile(struct gl_renderer *r, bool edges);
/* After the last: the planes are kept if all tiles have been collected. */
void collect_end(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request);
/* After a frame of one tile: they are kept. */
void planes_keep(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request);

#endif
