/* The renderer: draws frames from limit tables. The service uses every device through this header.
 * Each device is a folder below this one that implements the functions of device.h and has its name
 * in its own device.h.
 *
 * Thread: functions with a struct renderer are called by the thread that created it (the render
 * thread); all others by any thread. */
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

/* Opens a device. NULL with ERROR_DEVICE, which lists what was found, if there is none. *options is
 * copied.
 *
 * A device can be lost. Then the current tile fails with ERROR_GPU_LOST, and the next call opens
 * the same device again. Models and images are put on it again when they are next needed, and
 * frames continue with their next tile. */
struct renderer *renderer_create(const struct renderer_device *device,
                                 const struct renderer_options *options, struct error *error);
void renderer_destroy(struct renderer *renderer); /* NULL is safe */
const struct renderer_info *renderer_info(const struct renderer *renderer);

/* Puts tables on the device. The tables must stay valid until the model is destroyed: their bounds
 * choose the grids of every frame, and a device that was lost gets them again. NULL on failure. */
struct renderer_model *renderer_model_create(struct renderer *renderer,
                                             const struct limit_tables *tables,
                                             struct error *error);
void renderer_model_destroy(struct renderer *renderer, struct renderer_model *model);

/* Puts an image on the device. The image must stay valid until the renderer's is destroyed. NULL on
 * failure. */
struct renderer_image *renderer_image_create(struct renderer *renderer, const struct image *image,
                                             struct error *error);
void renderer_image_destroy(struct renderer *renderer, struct renderer_image *image);

/* True if the device takes tables on demand (tables.h); else tables must be stored. Any thread. */
bool renderer_takes_tables_on_demand(const struct renderer_device *device);
/* The following functions return the memory in bytes that a device takes, in addition to the main
 * memory of the caller. Any thread. */
/* for a model's tables */
size_t renderer_model_bytes(const struct renderer_device *device,
                            const struct limit_tables *tables);
/* for an image and its smaller copies */
size_t renderer_image_bytes(const struct renderer_device *device, const struct image *image);
/* to draw a frame. The device may keep all of it afterwards, for later frames of the same view. */
uint64_t renderer_frame_bytes(const struct renderer_device *device,
                              const struct renderer_frame_size *size);
/* for a frame of polygons between its steps, in tiles of this size */
uint64_t renderer_paused_bytes(const struct renderer_device *device, uint32_t width_px,
                               uint32_t height_px, uint64_t tile_px);

struct renderer_held renderer_held(const struct renderer *renderer);
/* Frees what is held for frames, kept views too: later frames are drawn anew. Frees programs beyond
 * the number of the usual ones, too. Safe between the steps of a frame. */
void renderer_drop_held(struct renderer *renderer);

/* Checks the request (ERROR_REQUEST names the field and its range), cuts the frame into tiles and
 * allocates its planes. If a frame is given up between two steps, call frame_work_finish() and
 * frame_finish(). A device may fail a step of a frame of polygons with ERROR_SERVER if too many
 * such frames are in progress: begun, and neither complete nor given up. */
bool renderer_begin(struct renderer *renderer, struct frame_work *work, struct frame *frame,
                    struct error *error);
/* Draws the next tile, or the next part of one, or prepares for it.
 *
 * Evaluated planes are kept: those of the last frame in one tile, those of the last frame with
 * fewer than 4,096 pixels, and those of the last frame in tiles in_place, if no other frame of that
 * kind was drawn between its tiles. A frame of the exact surface with the same model, size and
 * camera uses them, whatever its lights, patterns, colours and tiles: it is only shaded, in one
 * step. (Planes of polygons from a frame in one tile serve such frames, too.)
 *
 * A frame of the exact surface is the same, bit by bit, as one tile and in tiles in_place of any
 * size, which take as much memory on the device as one tile. (Exceptions: if more than 32,768
 * pixels show the rounding of a crease, these may have more rays in tiles. If more than 512 pixels
 * look through gaps narrower than a pixel, these show what lies behind only in tiles. Such planes
 * serve only frames that are cut alike.) In tiles that are not in_place the frame differs by the
 * rounding of single precision: so tiles must depend on the request alone if equal requests shall
 * give equal bytes. */
enum frame_step renderer_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error);

/* Frees what the device keeps for the frame's next step. Needed only for a frame that is given up;
 * safe at any time after struct frame_work was filled in. Any thread, also after the renderer was
 * destroyed. */
void frame_work_finish(struct frame_work *work);

/* Calls renderer_begin(), then renderer_step() until the frame is complete or has failed. */
bool renderer_render(struct renderer *renderer, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error);

/* The memory in bytes that the polygons of a model at a level (RANGE_LEVEL) take on the device,
 * from their first frame until the model is destroyed. 0: there are too many, and their frame fails
 * with the reason. Any thread. */
size_t renderer_polygon_bytes(const struct limit_tables *tables, uint32_t level);

/* Makes the polygons for frame_work.polygons; they take the same memory again in main memory. NULL
 * with ERROR_REQUEST if there are too many, or with ERROR_SERVER when memory is short or nobody
 * waits (checked for every face). Any thread. */
struct renderer_polygons *renderer_polygons_create(const struct limit_tables *tables,
                                                   uint32_t level, const struct frame_watch *watch,
                                                   struct error *error);
void renderer_polygons_destroy(struct renderer_polygons *polygons); /* NULL is safe */

#endif
