/* The planes that frames are drawn into, and what is known of those that are kept. Data; kept.h says
 * which planes a frame takes. GL thread. */
#ifndef SHEEN_RENDER_GL_PLANES_H
#define SHEEN_RENDER_GL_PLANES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/gl/target.h"
#include "server/scene/frame_request.h"

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

#endif
