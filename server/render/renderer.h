/* The renderer: limit tables in, frames out. The one header through which the service reaches the
 * GPU; no GL type or call appears here.
 *
 * Thread: functions that take a struct renderer are called by the thread that created it (the GL
 * thread); all others by any. */
#ifndef SHEEN_RENDER_RENDERER_H
#define SHEEN_RENDER_RENDERER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/block_cache.h"
#include "server/base/error.h"
#include "server/image/image.h"
#include "server/render/frame_watch.h"
#include "server/scene/frame.h"
#include "server/surface/tables.h"

struct renderer;
struct renderer_model;    /* one cage's tables on the GPU */
struct renderer_image;    /* one light image on the GPU */
struct renderer_polygons; /* a model's polygons of one level, in main memory */

struct renderer_options {
    const char *device; /* "auto", "software" or a number: the n-th EGL device */
    size_t max_texels;  /* tests only: pretend that buffer textures hold no more; 0: ask */
    size_t slice;      /* tests only: triangles of polygons drawn a step, about; 0: by the device */
    bool device_times; /* tests only: frame_times by timer queries on a software device, too */
    /* Told on the GL thread of every context that is lost, and of every try to open another one
     * that fails. NULL: nobody is. */
    void (*lost)(void *owner);
    void *owner;
    struct block_cache *block_cache; /* memory of frames, which outlives them; NULL: malloc's */
};
#define RENDERER_NAME_BYTES 256

/* What the device is, in its own words. Strings live as long as the renderer. */
struct renderer_info {
    const char *device; /* GL_RENDERER */
    const char *driver; /* GL_VERSION */
    bool software; /* EGL says so (EGL_MESA_device_software) or no hardware node is behind it */
    bool timed_by_device; /* frame_times are its own, by timer queries */
    uint32_t max_width_px, max_height_px;
    size_t max_texels; /* per buffer texture */
};

/* EGL by device enumeration, surfaceless, OpenGL 4.5 core. NULL with ERROR_DEVICE when there is
 * none, saying what was found.
 *
 * The device may go: a reset, or work that does not end (2 s; a software device has all time). The
 * tile that it was at fails with ERROR_GPU_LOST. What is called next opens the same device again;
 * models and images are put there again when they are drawn next, and frames go on with their next
 * tile. */
struct renderer *renderer_create(const struct renderer_options *options, struct error *error);
void renderer_destroy(struct renderer *renderer); /* NULL is safe */
const struct renderer_info *renderer_info(const struct renderer *renderer);

/* Uploads tables. The tables must stay until the model is destroyed (their bounds choose the
 * grids every frame, and a device that was lost gets them again). */
struct renderer_model *renderer_model_create(struct renderer *renderer,
                                             const struct limit_tables *tables,
                                             struct error *error);
void renderer_model_destroy(struct renderer *renderer, struct renderer_model *model);

/* What an image takes on the device, with all its smaller copies. Any thread. */
size_t renderer_image_bytes(const struct image *image);
/* Uploads an image, which must stay as tables do. */
struct renderer_image *renderer_image_create(struct renderer *renderer, const struct image *image,
                                             struct error *error);
void renderer_image_destroy(struct renderer *renderer, struct renderer_image *image);

/* A frame in the making, one tile a step, so that the GL thread can turn to other frames in
 * between; of polygons a step is a part of a tile, and they are put on the device in several, too.
 * Fill in the first group and call renderer_begin(), then renderer_step() until it says something
 * else than FRAME_MORE, FRAME_PROGRAM or FRAME_POLYGONS. */
struct frame_work {
    const struct frame_request *request; /* stays until the last step, as the model does */
    uint64_t tile_px;                    /* most pixels of one tile; 0: as many as fit at once */
    bool in_place; /* of an exact frame in tiles: its pixels must be those of one tile, bit by bit,
                      and its planes are kept. They are then as large as the whole picture;
                      renderer_begin() clears in_place where the device has no such images */
    struct frame_watch watch;
    const struct renderer_polygons *polygons; /* for after FRAME_POLYGONS; NULL until then */

    uint64_t serial; /* the renderer's own from here on */
    uint32_t tile_width, tile_height;
    uint32_t x, y;         /* of the next tile */
    unsigned stage;        /* of polygons: what comes next of it */
    size_t part;           /* and from where */
    unsigned n_programs;   /* made for it so far */
    struct canvas *canvas; /* what is drawn of its tile; NULL: nothing, or the frame is whole */
};

/* So many frames of polygons may be under way, begun and neither whole nor given up; one more fails
 * with ERROR_SERVER if it takes several steps a tile. */
enum { RENDERER_MAX_SLICED = 24 };

enum frame_step {
    FRAME_MORE, /* steps are left */
    /* No tile, but one of the programs that the frame takes was made for the device, which may take
     * as long as several: go on. */
    FRAME_PROGRAM,
    /* The device has no polygons for the request's surface, or no longer: set frame_work.polygons
     * and go on. Making them takes as long as many tiles. */
    FRAME_POLYGONS,
    FRAME_DONE,   /* the frame is whole */
    FRAME_FAILED, /* *error says why; ERROR_GPU_LOST: ask again. The frame is empty */
};

/* Checks the request (ERROR_REQUEST names the field and its range), cuts the frame into tiles and
 * makes its planes. A frame that is given up between two steps needs frame_work_finish() and
 * frame_finish(). */
bool renderer_begin(struct renderer *renderer, struct frame_work *work, struct frame *frame,
                    struct error *error);
/* Draws the next tile, or the next part of one, or makes ready for it.
 *
 * Evaluated planes are kept: those of the last frame of one tile, those of the last of fewer than
 * 4,096 pixels, and those of the last in tiles in_place, if no other frame of the kind was drawn
 * between its tiles. A frame of the exact surface of the same model, size and camera takes them,
 * whatever its light, pattern, colours and tiles: it has only stage 3, and one step. (Polygons kept
 * by a frame of one tile serve such frames.)
 *
 * A frame of the exact surface is the same, bit by bit, as one tile and in tiles in_place of any
 * size, which take as much of the device's memory as one tile does. (Where more than 32,768 of its
 * pixels show the rounding of a crease these may have more rays in tiles; where more than 512 look
 * through gaps narrower than themselves these may show what lies behind in tiles alone. Planes then
 * serve frames that are cut alike alone.) In tiles that are not in_place it is the same but for
 * single precision's rounding: so tiles must depend on the request alone where equal requests shall
 * give equal bytes. */
enum frame_step renderer_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error);

/* Gives back what the device has set aside for the frame's next step. Any thread, also when the
 * renderer has gone; needed only by a frame that is given up, safe after any step. */
void frame_work_finish(struct frame_work *work);

/* Begin and all steps at once. */
bool renderer_render(struct renderer *renderer, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error);

/* What the polygons of a model at a level (RANGE_LEVEL) take on the device, kept from their first
 * frame until the model goes. 0: they are too many, and their frame fails with the words for it.
 * Any thread. */
size_t renderer_polygon_bytes(const struct limit_tables *tables, uint32_t level);

/* What a frame of polygons takes on the device between its steps, cut into such tiles. Any thread.
 */
uint64_t renderer_canvas_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px);

/* Makes them for frame_work.polygons; they take as much again here. ERROR_REQUEST when they are too
 * many, ERROR_SERVER when memory is short or nobody waits (asked for every face). Any thread. */
struct renderer_polygons *renderer_polygons_create(const struct limit_tables *tables,
                                                   uint32_t level, const struct frame_watch *watch,
                                                   struct error *error);
void renderer_polygons_destroy(struct renderer_polygons *polygons); /* NULL is safe */

#endif
