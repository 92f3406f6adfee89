/* An opened GL device: the data that its stages share. Includes none of their functions. Private to
 * server/render/gl; GL thread. */
#ifndef SHEEN_RENDER_GL_DEVICE_INTERNAL_H
#define SHEEN_RENDER_GL_DEVICE_INTERNAL_H

#include "server/render/device.h"
#include "server/render/gl/context/context.h"
#include "server/render/gl/planes.h"
#include "server/render/gl/polygon_kept.h"
#include "server/render/gl/programs/kept_programs.h"
#include "server/render/gl/stages.h"
#include "server/render/patch_grids.h"
#include "server/render/tiles.h"

struct maker;

/* The tile that is drawn, as three rectangles of the picture. */
struct drawing {
    /* The part that the target's images hold, from their pixel (0, 0) on; contains the other
     * two. */
    struct tile place;
    /* What stages 1 and 2 draw: the tile and a margin, because stage 3 reads the pixels next to
     * each pixel. */
    struct tile drawn;
    struct tile shaded; /* what stage 3 shades: the tile, which is read back, or all of `drawn` */
};

struct gl_renderer {
    struct renderer base;
    char device[RENDERER_NAME_BYTES], driver[RENDERER_NAME_BYTES]; /* of base.info */
    struct context context;
    size_t max_texels; /* limit of a buffer texture */
    /* The planes in use, like struct planes. */
    struct target target;
    struct kept_view kept;
    enum planes_of in_use;
    struct planes resting[PLANES_KINDS]; /* the planes not in use */
    struct collecting collecting;        /* lists collected for PLANES_TILED */
    struct drawing drawing;
    struct stage_clock clock;
    struct tile inside;       /* the tile without its margin, in px of the target */
    struct frame_watch watch; /* watch of the current frame */
    /* Polygons of the current frame; NULL: the device has them. */
    const struct renderer_polygons *made;
    struct patch_grids grids;
    struct polygon_meshes meshes;
    struct paused_tiles *paused_tiles; /* they stay allocated when the device is lost */
    struct kept_programs *programs;    /* they are made again when the device is lost */
    struct maker *maker;               /* NULL while the device is lost */
    GLuint view_buffer;                /* struct view_block */
    struct visibility_stage visibility;
    struct gather_stage gather;
    struct evaluate_stage evaluate;
    struct edges_stage edges;
    struct polygon_stage polygons;
    struct shade_stage shade;
    uint64_t next_serial; /* serial number of the next model */
    uint64_t n_begun;     /* number of frames begun */
};

static inline struct gl_renderer *gl_renderer_of(struct renderer *renderer)
{
    return (struct gl_renderer *)(void *)renderer;
}

#endif
