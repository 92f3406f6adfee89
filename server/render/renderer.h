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

#include "server/base/error.h"
#include "server/scene/scene.h"
#include "server/image/image.h"
#include "server/surface/tables.h"
#include "server/base/block_cache.h"

struct renderer;
struct renderer_model;    /* one cage's tables on the GPU */
struct renderer_image;    /* one light image on the GPU */
struct renderer_polygons; /* a model's polygons of one level, in main memory */

/* Planes a frame can carry, one bit each. */
enum renderer_plane {
    PLANE_COLOUR = 1 << 0,       /* uint8_t[4] RGBA, straight alpha */
    PLANE_POSITION = 1 << 1,     /* float[3] world, NaN where nothing is hit */
    PLANE_NORMAL = 1 << 2,       /* float[3] unit, world, along the face winding; NaN where none */
    PLANE_PTEX = 1 << 3,         /* uint32 face (0xffffffff: none), float u, float v: 12 bytes */
    PLANE_LIGHT = 1 << 4,        /* float s, t on the first light; NaN where it is not met */
    PLANE_CURVATURE = 1 << 5,    /* float k.min, k.max, 1/unit, signed against N; NaN where none */
    PLANE_LIGHT_CHANGE = 1 << 6, /* float ds/dx ds/dy dt/dx dt/dy, a pixel; NaN as PLANE_LIGHT */
    PLANE_COVERAGE = 1 << 7,     /* float share of the pixel that shows surface, [0, 1] */
};
#define PLANE_COUNT 8

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

struct frame_request {
    uint32_t width_px, height_px;
    struct camera camera;
    struct lines lines;
    struct light lights[MAX_LIGHTS]; /* the first lies over the second, and so on */
    uint32_t n_lights;               /* 1 to MAX_LIGHTS */
    float miss[4];                   /* colour where no light is met */
    float empty[4];                  /* colour where no surface is hit */
    float base[4];                   /* of the surface, where patterns are transparent */
    bool unfiltered;                 /* one sample a pixel, for comparison */
    bool count_light;                /* say in frame.met_px where lights are met */
    uint32_t planes;                 /* enum renderer_plane bits to read back */
    struct surface surface;
};

/* What each stage took of the device's time, without what the processor did meanwhile, where
 * renderer_info says timed_by_device; else by the clock, waiting for the device after each.
 * Readback: by the clock. */
struct frame_times {
    uint64_t visibility_us, evaluate_us, shade_us, readback_us;
};

/* One finished frame. Plane pointers are rows top first, tightly packed, NULL when not asked for;
 * they belong to the caller, who gives them back with frame_finish(). */
struct frame {
    uint32_t width_px, height_px;
    void *plane[PLANE_COUNT]; /* indexed by bit number */
    struct frame_times times;
    bool shows_surface; /* false: no pixel shows any of the model */
    /* With frame_request.count_light: how many pixels show surface at their centre, and on how many
     * of these the reflected ray meets a light. They are samples for a share, met_px / seen_px: all
     * pixels of tiles of fewer than 2^18, one in eight of larger tiles; and where no light can be
     * missed, nothing is counted and both get 1 for each tile that shows surface. */
    uint64_t seen_px, met_px;
    struct block_cache *block_cache; /* the renderer's: where the planes come from */
    struct canvas *canvas; /* the renderer's, between two steps; NULL once the frame is whole */
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

/* Who waits for a frame: asked between its tiles and its lights, and the faces of its polygons.
 * Once nobody does the frame fails, so that a client that has gone holds nobody up. */
struct frame_watch {
    bool (*is_abandoned)(void *owner); /* NULL: never; called by who draws or makes polygons */
    void *owner;
};

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
    uint32_t x, y;       /* of the next tile */
    unsigned stage;      /* of polygons: what comes next of it */
    size_t part;         /* and from where */
    unsigned n_programs; /* made for it so far */
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
 * makes its planes. A frame that is given up between two steps needs frame_finish() alone, on any
 * thread, also when the renderer has gone. */
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

/* Begin and all steps at once. */
bool renderer_render(struct renderer *renderer, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error);
void frame_finish(struct frame *frame);

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

/* Bytes of one pixel of a plane (a single bit). */
size_t renderer_plane_bytes(enum renderer_plane plane);

/* Which way is up where no file says it: y when the box is thinner in y than in z by more than 1 %,
 * else z. */
void renderer_guess_up(const double box_min[3], const double box_max[3], double up[3]);

/* A camera that frames the model: 35 degrees, 4 % of the picture free at the two opposite edges
 * that it comes nearest to. `up` says where above is, of any length; NULL: guessed. */
void renderer_default_camera(const struct limit_tables *tables, const double up[3],
                             enum default_view view, uint32_t width_px, uint32_t height_px,
                             struct camera *camera);

/* Sets camera->up for a model whose up is `up`, of any length but 0; eye and target must be set.
 * Where the camera does not look along it (within 1e-6 rad): to `up` itself. Where it does: to the
 * horizontal direction that the front view looks along when the camera looks down, to the opposite
 * one when it looks up. */
void renderer_default_roll(const double up[3], struct camera *camera);

/* Looks closer at a place of the picture: (x, y) is (0, 0) at its top left and (1, 1) at its bottom
 * right (RANGE_ZOOM_AT) and comes to lie in its middle; `factor` is RANGE_ZOOM. A perspective
 * camera's eye stays and its target moves, so that lines stay where they are on the surface; an
 * orthographic camera's eye and target both move across. fov_deg and ortho_height both become
 * smaller, whichever the camera uses, and may leave their ranges, which is for the caller to check.
 */
void renderer_zoom(struct camera *camera, uint32_t width_px, uint32_t height_px, double factor,
                   double x, double y);

/* Sets centre, u and v for the light's kind, by the box and `up` (NULL: guessed) alone, so that
 * lines stay where they are whoever looks. Lines run along the longer of the model's horizontal
 * sides. A tunnel is about that direction, three times as wide as the box: every ray from the model
 * meets it but one that runs along its axis. A sphere is that tunnel, infinitely wide; rectangle
 * and plane hang over the model, seen from below where one-sided. */
void renderer_default_light(const double box_min[3], const double box_max[3], const double up[3],
                            struct light *light);

#endif
