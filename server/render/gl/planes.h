/* The planes that frames are drawn into, and what is known of kept planes. Data; kept.h chooses
 * planes. GL thread. */
#ifndef SHEEN_RENDER_GL_PLANES_H
#define SHEEN_RENDER_GL_PLANES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/gl/target.h"
#include "server/render/kept_view.h"

/* A target, and the view that its planes hold. */
struct planes {
    struct target target;
    struct kept_view kept;
};

/* Which planes a frame is drawn into. There are several, so that a frame of one kind does not
 * overwrite planes that are kept for another. */
enum planes_of {
    PLANES_WHOLE, /* the last frame drawn in one tile; kept */
    /* The last such frame with few pixels, which must not overwrite a larger view; kept. */
    PLANES_SMALL,
    /* The last frame in several tiles in_place: the target is the whole picture, and each tile
     * fills its part; kept if no other such frame came in between. */
    PLANES_TILED,
    /* One tile of a frame in tiles that are not in_place, never kept; also the lists of a tile
     * in_place until they are collected. */
    PLANES_APART,
    PLANES_KINDS
};

/* The progress of collecting lists for a frame in tiles in_place: the lists of each tile are
 * appended to those of the whole picture, over which stage 3 of a later frame runs. */
enum { COLLECTED_LISTS = 3 };
struct collecting {
    /* gl_frame.serial of the frame whose tiles have all been collected so far; 0: none, or it was
     * given up. */
    uint64_t frame;
    GLuint n[COLLECTED_LISTS]; /* number of entries of each list so far */
};

#endif
