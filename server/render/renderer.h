/* The renderer: limit tables in, frames out. The one header through which the service reaches a
 * device, whichever it is: each is a folder below this one, which fills in the functions of
 * device.h and gives them a name in its own device.h.
 *
 * Thread: functions that take a struct renderer are called by the thread that created it (the
 * render thread); all others by any. */
#ifndef SHEEN_RENDER_RENDERER_H
#define SHEEN_RENDER_RENDERER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/image/image.h"
#include "server/render/frame_watch.h"
#include "server/render/frame_work.h"
#include "server/render/renderer_options.h"
#include "server/scene/frame.h"
#include "server/surface/tables.h"

struct renderer_device;   /* a kind of device: its functions */
struct renderer;          /* a device that has been opened */
struct renderer_model;    /* one cage's tables on the device */
struct renderer_image;    /* one light image on the device */
struct renderer_polygons; /* a model's polygons of one level, in main memory */

/* Opens a device. NULL with ERROR_DEVICE when there is none, saying what was found.
 *
 * The device may be lost. Then the tile that it was drawing fails with ERROR_GPU_LOST, and the next
 * call opens the same device again. Models and images are put on it again when they are next drawn,
 * and frames go on with their next tile. */
struct renderer *renderer_create(const struct renderer_device *device,
                                 const struct renderer_options *options, struct error *error);
void renderer_destroy(struct renderer *renderer); /* NULL is safe */
const struct renderer_info *renderer_info(const struct renderer *renderer);

/* Puts tables on the device. The tables must stay until the model is destroyed: their bounds choose
 * the grids every frame, and a device that was lost gets them again. */
struct renderer_model *renderer_model_create(struct renderer *renderer,
                                             const struct limit_tables *tables,
                                             struct error *error);
void renderer_model_destroy(struct renderer *renderer, struct renderer_model *model);

/* Puts an image on the device. The image must stay as tables do. */
struct renderer_image *renderer_image_create(struct renderer *renderer, const struct image *image,
                                             struct error *error);
void renderer_image_destroy(struct renderer *renderer, struct renderer_image *image);

/* Whether it takes tables on demand (tables.h); else they must be stored ones. Any thread. */
bool renderer_takes_tables_on_demand(const struct renderer_device *device);
/* Memory that the device takes beside the main memory of its caller. Any thread. */
/* For a model's tables. */
size_t renderer_model_bytes(const struct renderer_device *device,
                            const struct limit_tables *tables);
/* For an image and what is made of it. */
size_t renderer_image_bytes(const struct renderer_device *device, const struct image *image);
/* For a frame of polygons between its steps, cut into such tiles. */
uint64_t renderer_paused_bytes(const struct renderer_device *device, uint32_t width_px,
                               uint32_t height_px, uint64_t tile_px);

/* Checks the request (ERROR_REQUEST names the field and its range), cuts the frame into tiles and
 * makes its planes. A frame that is given up between two steps needs frame_work_finish() and
 * frame_finish(). A device may fail a step of a frame of polygons with ERROR_SERVER where too many
 * other such frames are under way: begun, and neither whole nor given up. */
bool renderer_begin(struct renderer *renderer, struct frame_work *work, struct frame *frame,
                    struct error *error);
/* Draws the next tile, or the next part of one, or makes ready for it.
 *
 * Evaluated planes are kept: those of the last frame of one tile, those of the last of fewer than
 * 4,096 pixels, and those of the last in tiles in_place, if no other frame of the kind was drawn
 * between its tiles. A frame of the exact surface of the same model, size and camera takes them,
 * whatever its light, pattern, colours and tiles: it is shaded alone, in one step. (Polygons kept
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

/* Gives back what the device keeps for the frame's next step. Any thread, also when the renderer
 * has gone; needed only by a frame that is given up, safe at any time after struct frame_work has
 * been filled in. */
void frame_work_finish(struct frame_work *work);

/* Calls renderer_begin() and then renderer_step() until the frame is whole or has failed. */
bool renderer_render(struct renderer *renderer, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error);

/* What the polygons of a model at a level (RANGE_LEVEL) take on the device, kept from their first
 * frame until the model goes. 0: they are too many, and their frame fails with the words for it.
 * Any thread. */
size_t renderer_polygon_bytes(const struct limit_tables *tables, uint32_t level);

/* Makes them for frame_work.polygons; they take as much again here. ERROR_REQUEST when they are too
 * many, ERROR_SERVER when memory is short or nobody waits (asked for every face). Any thread. */
struct renderer_polygons *renderer_polygons_create(const struct limit_tables *tables,
                                                   uint32_t level, const struct frame_watch *watch,
                                                   struct error *error);
void renderer_polygons_destroy(struct renderer_polygons *polygons); /* NULL is safe */

#endif
