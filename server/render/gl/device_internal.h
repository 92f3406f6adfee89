/* A device that has been opened: what its stages share. Data, which names no function of them.
 * Private to server/render/gl; GL thread. */
#ifndef SHEEN_RENDER_GL_DEVICE_INTERNAL_H
#define SHEEN_RENDER_GL_DEVICE_INTERNAL_H

#include "server/render/device.h"
#include "server/render/gl/context/context.h"
#include "server/render/gl/planes.h"
#include "server/render/gl/polygon_kept.h"
#include "server/render/gl/programs/table_programs.h"
#include "server/render/gl/stages.h"
#include "server/render/patch_grids.h"
#include "server/render/tiles.h"

/* The tile being drawn, as three rectangles of the picture. */
struct drawing {
    struct tile place;  /* the part of it that the target's images hold, from their pixel (0, 0)
                           on; contains the other two */
    struct tile drawn;  /* what stages 1 and 2 draw: the tile, and a margin for stage 3, which reads
                           the pixels beside each pixel */
    struct tile shaded; /* what stage 3 shades: the tile, which is read back, or all of `drawn` */
};

struct gl_renderer {
    struct renderer base;
    char device[RENDERER_NAME_BYTES], driver[RENDERER_NAME_BYTES]; /* of base.info */
    struct context context;
    size_t max_texels; /* of a buffer texture */
    /* The planes in use, as in struct planes. */
    struct target target;
    struct kept kept;
    enum planes_of in_use;
    struct planes resting[PLANES_KINDS]; /* the others */
    struct collecting collecting;        /* into PLANES_TILED */
    struct drawing drawing;
    struct stage_clock clock;
    struct tile inside;       /* the tile being drawn, without its margin, px of the target */
    struct frame_watch watch; /* of the frame being drawn */
    const struct renderer_polygons *made; /* its polygons; NULL: the device has them */
    struct patch_grids grids;
    struct polygon_meshes meshes;
    struct paused_tiles *paused_tiles; /* they stay where they are when the device is lost */
    struct program_sets programs;
    GLuint view_buffer; /* struct view_block */
    struct visibility_stage visibility;
    struct gather_stage gather;
    struct evaluate_stage evaluate;
    struct edges_stage edges;
    struct polygon_stage polygons;
    struct shade_stage shade;
    uint64_t next_serial; /* of models */
    uint64_t n_begun;     /* frames */
};

static inline struct gl_renderer *gl_renderer_of(struct renderer *renderer)
{
    return (struct gl_renderer *)(void *)renderer;
}

#endif
