/* What the renderer's files share. Private to server/render/gl; GL thread only. */
#ifndef SHEEN_RENDER_GL_GPU_H
#define SHEEN_RENDER_GL_GPU_H

#include <epoxy/gl.h>
#include <stdatomic.h>

#include "server/render/gl/egl.h"
#include "server/render/mesh.h"
#include "server/render/patch_grids.h"
#include "server/render/device.h"
#include "server/render/gl/shade_programs.h"
#include "server/render/view.h"

/* The least number from `size` on that is no power of two, for the sides of images and the bytes of
 * buffer textures. llvmpipe compiles a program anew for a texture whose size is a power of two
 * where those before were not, which takes up to seconds; sizes that never are cost that once. */
static inline size_t no_power_of_two(size_t size)
{
    while (!(size & (size - 1)))
        size++;
    return size;
}

/* How many buffer textures each table may be spread over (shaders/tables.glsl). */
enum { MAX_POINT_BANKS = 8, MAX_NODE_BANKS = 4, MAX_ADJACENCY_BANKS = 2 };

/* A table in one or more buffer textures. */
struct bank_set {
    GLuint buffer[MAX_POINT_BANKS];
    GLuint texture[MAX_POINT_BANKS];
    int n;
};

/* The programs that read tables spread over so many banks, and write PLANE_PTEX or not. */
struct table_programs {
    int point_banks, node_banks, adjacency_banks;
    bool ptex;
    GLuint visibility, evaluate, unsolved, rounded, silhouette;
    uint64_t used; /* by the clock of struct gl_renderer */
};

/* Which context of the renderer an object's GL names are of. Those of an earlier one went with it:
 * they are dropped, never deleted, since they may be another object's by now. */
typedef uint32_t context_number; /* from 1; 0: of none, the object is not on the device */

struct gl_model {
    struct renderer_model base;
    struct clusters clusters; /* of the tables */
    context_number context;
    struct bank_set points, nodes, adjacency;
    uint64_t serial; /* never reused: tells whose planes are kept */
};

struct gl_image {
    struct renderer_image base;
    context_number context;
    GLuint texture;
};

/* A list of pixels on the device, a head before its entries; and what is known of a rounded pixel's
 * 16 rays (shaders/list.glsl, rounded.glsl). */
enum { LIST_BYTES = 4, LIST_HEAD_BYTES = 16, ROUNDED_BYTES = 512 };

/* Workgroups of a row: a device takes a limited number in one dimension (65,535 at least), so
 * dispatches over more go in rows (ROW of shaders/list.glsl). */
enum { GROUP_ROW = 32768 };

/* The images of one tile, grown to the largest tile asked for. */
struct target {
    uint32_t width, height;
    uint64_t most_asked_px; /* pixels of the largest tile asked for */
    GLuint framebuffer;
    GLuint seen, seen_depth; /* visibility: RG32UI, DEPTH32F */
    GLuint hit_depth;        /* evaluate: R32F */
    GLuint normal, shape;    /* RGBA32F, RG32F */
    GLuint ptex;             /* RGBA32UI */
    GLuint border;           /* R32UI: two halves, shaders/planes.glsl */
    GLuint silhouette;       /* R32UI: shaders/silhouette.comp.glsl */
    GLuint colour;           /* RGBA8 */
    GLuint light, curvature; /* RG32F */
    GLuint light_change;     /* RGBA32F */
    GLuint coverage;         /* R32F: share of the pixel that shows surface */
    GLuint groups, restless; /* buffers: shaders/gather.comp.glsl */
    GLuint strays, unsolved; /* buffers: shaders/unsolved.comp.glsl */
    GLuint edges, turns;     /* buffers: shaders/edges_find.comp.glsl */
    GLuint rounded;          /* another; and what its pixels' rays meet: shaders/rounded.glsl */
    GLuint rounded_hits;
    GLuint lights[2];   /* what lights behind others show: RGBA16F, shaders/shown.glsl; or 0 */
    GLuint missed[2];   /* R16F */
    GLuint max_rounded; /* pixels of which rounded_hits has room for all rays; 0: there is none */
};

/* One chunk of a mesh: a driver that clears a buffer when it makes one takes long for a large one.
 */
struct polygon_chunk {
    GLuint array, buffer[2]; /* vertices, indices */
    struct mesh_chunk of;
};

/* One mesh of polygons on the device. */
struct polygon_mesh {
    uint64_t model_serial; /* 0: a free place */
    uint32_t level;
    struct mesh_part *part; /* owned, as the chunks are */
    struct polygon_chunk *chunk;
    size_t n_parts, n_chunks;
    size_t n_put;  /* chunks that the device has */
    size_t bytes;  /* on the device, in the end */
    uint64_t used; /* by the cache's clock */
    double centre[3];
};

enum { MAX_POLYGON_MESHES = 32 };

/* The conventional picture's meshes (polygon_meshes.c) and programs (polygon.c). All zero until
 * first used. */
struct polygons {
    struct polygon_mesh mesh[MAX_POLYGON_MESHES];
    size_t bytes; /* of all meshes */
    uint64_t clock;
    GLuint fill, edges; /* programs */
    GLuint framebuffer;
};

/* What the planes of a target hold, so that a frame of the same view needs stage 3 alone. */
struct kept {
    uint64_t model_serial; /* 0: nothing */
    uint32_t width_px, height_px;
    struct camera camera;
    struct surface surface;
    bool ptex, edges;
    bool any_cut; /* the planes are bit-equal however the frame is tiled: they serve any tiling */
};

/* A target, and which view its planes hold. */
struct planes {
    struct target target;
    struct kept kept;
};

/* Which planes a frame is drawn into: there are several, so that frames of other kinds leave those
 * that are kept alone (kept.c). */
enum planes_of {
    PLANES_WHOLE, /* hold the last frame that was one tile; kept */
    PLANES_SMALL, /* the last such frame of few pixels, which would otherwise cost a larger view its
                     planes; kept */
    PLANES_TILED, /* the last frame of several tiles in_place: the target stands for the whole
                     picture, and each tile fills its part; kept if no other such frame came in
                     between */
    PLANES_APART, /* one tile of a frame in tiles that are not in_place, never kept; and the lists
                     of a tile in_place until they are collected */
    PLANES_KINDS
};

/* The tile being drawn, as three rectangles of the picture. */
struct drawing {
    struct tile place;  /* the part of it that the target's images hold, from their pixel (0, 0)
                           on; contains the other two */
    struct tile drawn;  /* what stages 1 and 2 draw: the tile, and a margin for stage 3, which reads
                           the pixels beside each pixel */
    struct tile shaded; /* what stage 3 shades: the tile, which is read back, or all of `drawn` */
};

/* How far a frame in tiles in_place has come with its lists: each tile has lists of its own, which
 * are appended to those of the whole picture, and stage 3 of a later frame runs over these. */
enum { COLLECTED_LISTS = 4 };
struct collecting {
    uint64_t frame; /* gl_frame.serial of the frame whose tiles have all been collected so far;
                       0: there is none, or it was given up */
    GLuint n[COLLECTED_LISTS]; /* entries of each list so far */
};

/* What a tile of polygons goes through. */
enum tile_stage { TILE_FILL, TILE_SHADE, TILE_EDGES, TILE_WHOLE };

/* What a frame of polygons has drawn of its tile, while others are drawn between its steps
 * (slices.c). */
enum { MAX_PAUSED_TILES = RENDERER_MAX_SLICED };
struct paused_tile {
    struct planes planes;
    context_number context; /* of the planes */
    uint64_t model_serial;  /* whose mesh of this level the device must keep meanwhile */
    uint32_t level;
    atomic_bool is_taken; /* by a frame, which gives it back on any thread */
    struct paused_tiles *set;
};

/* On the heap: frames may give theirs back when the renderer has gone. */
struct paused_tiles {
    atomic_uint holders; /* the renderer, and the frames with a paused; the last one frees it */
    struct paused_tile paused[MAX_PAUSED_TILES];
};

/* What a frame does between two steps. */
struct gl_frame {
    struct frame_state base;
    struct block_cache *block_cache; /* where it lies */
    const struct frame_work *work;   /* during a step */
    uint64_t serial;                 /* of all frames begun */
    struct tile_size tile;
    uint32_t x, y;              /* of the next tile */
    enum tile_stage stage;      /* of polygons: what comes next of it */
    size_t part;                /* and from where */
    unsigned n_programs;        /* made for it so far */
    struct paused_tile *paused; /* what is drawn of its tile; NULL: nothing */
};

/* A part of a tile's polygons. */
struct slice {
    const struct polygon_mesh *mesh;
    const struct view *view;
    const struct tile *tile;
    size_t part;      /* the next one to draw */
    size_t left;      /* indices that may be drawn yet; the last part may exceed them */
    size_t at_once;   /* indices after which the device shall begin with them */
    size_t not_begun; /* indices that it has been given since */
};

/* Of the stages of one tile (stage_clock.c). */
enum { MAX_CLOCKED_STAGES = 3 };
struct stage_clock {
    GLuint mark[MAX_CLOCKED_STAGES][2];  /* queries: each stage's start and end on the device */
    uint64_t *stage[MAX_CLOCKED_STAGES]; /* where its time is added */
    int n;                               /* stages that have ended since the last reading */
    uint64_t since_us;                   /* when the clock was last read */
};

/* What finds and solves the pixels whose ray passes between two silhouettes
 * (shaders/gaps.comp.glsl). */
struct gaps {
    GLuint find;          /* program */
    GLuint ends, guesses; /* buffers: shaders/unsolved.comp.glsl */
    bool too_many; /* the last tile drawn has more than MAX_GAPS, so all of them stay empty */
};
/* Pixels in gaps that one tile may ask for: each takes the processor 0.03 to 2 ms, and few pictures
 * have more than two or three. */
enum { MAX_GAPS = 512 };

/* Most models take one or two: their tables fill a bank each. */
enum { MAX_PROGRAM_SETS = 4 };

struct gl_renderer {
    struct renderer base;
    struct egl egl;
    char device[RENDERER_NAME_BYTES], driver[RENDERER_NAME_BYTES]; /* of base.info */
    context_number context;
    bool is_lost; /* the context: nothing but opening another one makes a GL call */
    /* In use: as struct planes. */
    struct target target;
    struct kept kept;
    enum planes_of in_use;
    struct planes resting[PLANES_KINDS]; /* the others */
    struct collecting collecting;        /* into PLANES_TILED */
    struct drawing drawing;
    struct stage_clock clock;
    struct tile inside;                   /* of the tile being drawn: without its margin */
    struct frame_watch watch;             /* of the frame being drawn */
    const struct renderer_polygons *made; /* its polygons; NULL: the device has them */
    struct pieces pieces;
    struct polygons polygons;
    struct paused_tiles *paused_tiles; /* they stay where they are when the device is lost */
    struct table_programs programs[MAX_PROGRAM_SETS];
    int n_programs;
    uint64_t programs_clock;
    struct shade_programs shading;
    GLuint edges_find, edges_doubt;
    GLuint view_buffer, light_buffer, piece_buffer;
    GLuint gather, doubt; /* programs */
    struct gaps gaps;
    GLuint block_buffer;  /* pieces.block of the last tile gathered */
    GLuint piece_texture; /* of piece_buffer */
    GLuint vertex_array;
    GLuint grid_buffer; /* element indices of an instance of each grid */
    size_t grid_first[PIECE_GRIDS];
    GLuint blank_texture; /* stands in where a pattern has no image */
    GLuint no_groups;     /* a buffer: the dispatch of nothing */
    uint64_t next_serial;
    uint64_t n_begun; /* frames */
};

/* The device's own objects, by the heads that others know them by. */
static inline struct gl_model *gl_model_of(struct renderer_model *model)
{
    return (struct gl_model *)(void *)model;
}
static inline struct gl_image *gl_image_of(struct renderer_image *image) /* NULL: NULL */
{
    return (struct gl_image *)(void *)image;
}
static inline struct gl_frame *gl_frame_of(const struct frame_work *work)
{
    return (struct gl_frame *)(void *)work->state;
}
static inline struct gl_renderer *gl_renderer_of(struct renderer *renderer)
{
    return (struct gl_renderer *)(void *)renderer;
}

/* Makes sure that there is a context: opens another one in place of one that is lost, as the first
 * was. ERROR_GPU_LOST when the device gives none yet. */
bool gl_ready(struct gl_renderer *renderer, struct error *error);
/* Has the context been lost? Once so, always, until another is opened. */
bool gl_check_lost(struct gl_renderer *renderer);
/* Are these names of the context that there is? */
static inline bool is_current(const struct gl_renderer *renderer, context_number context)
{
    return context == renderer->context && !renderer->is_lost;
}
/* Waits for the device. False when it is lost, as one is that does not come back in time. */
bool gl_wait(struct gl_renderer *renderer);

/* Has the device timer queries that tell the truth? */
bool stage_clock_by_device(const struct gl_renderer *renderer);
void stage_clock_init(struct gl_renderer *renderer);
/* A tile begins: what the processor does from here on belongs to its first stage by the clock. */
void stage_clock_begin(struct gl_renderer *renderer);
/* The device is about to get the commands of a stage, and has got them all. The stage's time is
 * added to *stage, by the clock after waiting for the device, or by stage_clock_read(), until which
 * the pointer stays. False when the device is lost. */
void stage_clock_start(struct gl_renderer *renderer);
bool stage_clock_end(struct gl_renderer *renderer, uint64_t *stage);
/* Waits for the stages that have ended, where that has not been done, and adds their times. False
 * when the device is lost. */
bool stage_clock_read(struct gl_renderer *renderer);
/* Waits for the device and adds what has passed by the clock. False when it is lost. */
bool stage_clock_wait(struct gl_renderer *renderer, uint64_t *stage);

/* As struct renderer_device has them. */
struct renderer_model *gl_model_create(struct renderer *renderer, const struct limit_tables *tables,
                                       struct error *error);
void gl_model_destroy(struct renderer *renderer, struct renderer_model *model);
struct renderer_image *gl_image_create(struct renderer *renderer, const struct image *image,
                                       struct error *error);
void gl_image_destroy(struct renderer *renderer, struct renderer_image *image);
size_t gl_image_bytes(const struct image *image);
uint64_t gl_paused_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px);
bool gl_frame_begin(struct renderer *renderer, struct frame_work *work, struct error *error);
enum frame_step gl_frame_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error);

/* Puts on the device what is not there. */
bool model_upload(struct gl_renderer *renderer, struct gl_model *model, struct error *error);
bool image_upload(struct gl_renderer *renderer, struct gl_image *image, struct error *error);

/* Every bank of a set bound to texture units from `unit`; returns the next free unit. */
int banks_bind(const struct bank_set *set, int unit);

/* The programs for a model that is on the device, until the next call: compiled where they are not
 * kept, in place of those not asked for for longest where there is no room. NULL with ERROR_DEVICE
 * when the driver cannot. */
const struct table_programs *programs_for(struct gl_renderer *renderer,
                                          const struct gl_model *model, bool ptex,
                                          struct error *error);

/* Makes the target hold a tile, and mostly what it held before. ERROR_DEVICE when the device has no
 * memory. */
bool target_reserve(struct target *target, uint32_t width, uint32_t height, struct error *error);
/* Whether the device has images as large as a target for the whole of a frame. */
bool target_can_hold(const struct renderer_info *info, const struct frame_request *request);
/* What it takes then. */
uint64_t target_bytes(uint32_t width, uint32_t height);
/* And to hold what stage_rounded() finds, which frames of polygons do not need. */
bool target_reserve_rounded(struct target *target, struct error *error);
/* The planes of a frame of two lights and more. */
bool target_reserve_lights(struct target *target, struct error *error);
/* Of how many pixels of a tile all rays are met; it depends on the tile alone. */
GLuint target_max_rounded(const struct tile *tile);
/* So many or fewer, and the tile may be cut in any way. */
enum { ROUNDED_IN_ANY_CUT = 32768 };
/* The lists of pixels change places. */
void target_swap_lists(struct target *a, struct target *b);
void target_finish(struct target *target);

/* The three stages, on the tile that the view block in view_buffer describes. */
bool stage_visibility_init(struct gl_renderer *renderer, struct error *error);
void stage_visibility(struct gl_renderer *renderer, const struct gl_model *model,
                      const struct table_programs *programs);
bool stage_evaluate_init(struct gl_renderer *renderer, struct error *error);
void stage_evaluate(struct gl_renderer *renderer, const struct gl_model *model,
                    const struct table_programs *programs);
/* After it: the pixels of which stage 1 has seen nothing but triangles beyond silhouettes. Waits
 * for the device. Errors as pieces_choose(). */
bool stage_gaps(struct gl_renderer *renderer, const struct gl_model *model,
                const struct table_programs *programs, const struct view *view,
                struct error *error);
/* Lists the pixels of a part of the target that stage 3 looks at more closely; the coverage of all
 * others there. Lists around it too those that silhouettes are wanted of, in the list `strays` that
 * stage 2 is done with, as it is with `unsolved`, which holds those at edges. */
bool stage_edges_init(struct gl_renderer *renderer, struct error *error);
void stage_edges(struct gl_renderer *renderer, const struct tile *shaded);
/* After it: where the pieces that these show end at silhouettes. */
void stage_silhouette(struct gl_renderer *renderer, const struct gl_model *model,
                      const struct table_programs *programs);
/* After it: the pixels at edges become the list `edges`, but where that does not agree with what
 * the pixels around show: they go to `rounded`. */
void stage_edges_doubt(struct gl_renderer *renderer);
/* After it: the rays of the pixels that show the rounding of a crease, against the surface. */
void stage_rounded(struct gl_renderer *renderer, const struct gl_model *model,
                   const struct table_programs *programs);
/* Stages 1 and 2 of polygons: the same planes from a mesh that is whole. Empty, then slice by
 * slice. */
bool stage_polygons_begin(struct gl_renderer *renderer, const struct tile *tile,
                          struct error *error);
bool stage_polygons(struct gl_renderer *renderer, struct slice *slice, struct error *error);
/* A plane's pixels that stage 3 is about to write. */
void clear_shaded(const struct gl_renderer *renderer, GLuint texture, GLenum format,
                  const GLfloat *texel);
bool stage_shade_init(struct gl_renderer *renderer, struct error *error);
/* Makes one of the programs that the frame takes and that are not there yet, or says that they are
 * all there, for the target as it is: until the next call. */
bool stage_shade_prepare(struct gl_renderer *renderer, const struct frame_request *request,
                         bool *is_ready, struct error *error);
bool stage_shade(struct gl_renderer *renderer, const struct frame_request *request,
                 struct error *error);
/* After stage_shade: adds to frame.seen_px and met_px what the tile has of them. */
void shade_read_share(const struct gl_renderer *renderer, const struct frame_request *request,
                      bool any_seen, struct frame *frame);

/* After stage_shade: the polygons' edges in place of the colour, by the depths of stage_polygons,
 * slice by slice. */
bool stage_wireframe(struct gl_renderer *renderer, struct slice *slice, struct error *error);

/* Are they on the device, wholly? */
bool polygons_have(struct polygons *polygons, uint64_t model_serial, uint32_t level);
bool polygons_are_whole(const struct polygon_mesh *mesh);
/* The mesh, after putting the next chunks of it on the device, about so many bytes, from
 * renderer.made, unless it is whole. NULL on failure. */
struct polygon_mesh *polygons_put(struct gl_renderer *renderer, const struct gl_model *model,
                                  uint32_t level, size_t most, struct error *error);
/* Drops the meshes of a model that goes. */
void polygons_forget(struct polygons *polygons, uint64_t model_serial);
/* Drops all after the context that they were in. */
void polygons_lose(struct polygons *polygons);

/* Whether planes hold all that stages 1 and 2 would draw for this request. */
bool is_kept(const struct kept *kept, const struct gl_model *model,
             const struct frame_request *request);
/* The planes in use change places with others. */
void planes_swap(struct gl_renderer *renderer, struct planes *others);
/* Takes into use the planes that a frame's next tile is drawn into. At the first tile of a frame
 * whose view some planes hold already, these are taken, and own->tile is set to the frame's size:
 * it has only stage 3 left, in one tile. */
void planes_choose(struct gl_renderer *renderer, const struct gl_model *model,
                   struct gl_frame *own);
/* Before a tile is drawn into PLANES_TILED: what they hold is lost, unless it is the frame's own.
 */
void collect_begin(struct gl_renderer *renderer, const struct gl_frame *own);
/* After a tile: the lists of PLANES_APART join those of the tiles before, those at edges too. */
void collect_tile(struct gl_renderer *renderer, bool edges);
/* After the last: the planes are kept if all tiles have been collected. */
void collect_end(struct gl_renderer *renderer, const struct gl_model *model,
                 const struct frame_request *request);
/* After a frame of one tile: they are kept. */
void planes_keep(struct gl_renderer *renderer, const struct gl_model *model,
                 const struct frame_request *request);

/* NULL when memory is short. Released once by the renderer, any thread. */
struct paused_tiles *paused_tiles_create(void);
void paused_tiles_release(struct paused_tiles *set);
/* Takes into use what the frame has drawn of its tile, if anything. */
void tile_resume(struct gl_renderer *renderer, struct gl_frame *own);
/* The next part of a tile of polygons, as much as a step may take. *is_whole: it was the last, and
 * stands in the frame. */
bool draw_polygons(struct gl_renderer *renderer, const struct gl_model *model, struct gl_frame *own,
                   const struct view *view, const struct tile *drawn, struct frame *frame,
                   bool *is_whole, struct error *error);
/* Keeps what is drawn until the frame's next step: others may use the planes meanwhile. */
bool tile_pause(struct gl_renderer *renderer, const struct gl_model *model, struct gl_frame *own,
                struct error *error);
/* The frame needs it no more. Any thread. */
void tile_give_back(struct gl_frame *own);
/* Is a frame under way that is drawn of this mesh? */
bool mesh_is_needed(const struct gl_renderer *renderer, const struct polygon_mesh *mesh);

/* Draws into a framebuffer from here on: the part of the picture that it stands for, and of that
 * `drawn` alone; nearest first by reversed depth. */
void raster_begin(GLuint framebuffer, const struct tile *place, const struct tile *drawn);

/* After stage 1 or polygons: lists the pixels near what is seen, target.groups, over which
 * dispatch_groups() runs a program; and those that may have to ask their neighbours,
 * target.restless. Planes that it writes must be cleared before: it leaves gaps. */
bool stage_gather_init(struct gl_renderer *renderer, struct error *error);
void stage_gather(struct gl_renderer *renderer);
/* Has it found any, for the tile that was drawn last? Waits for the device. */
bool gather_found_any(const struct gl_renderer *renderer);
void dispatch_groups(GLuint program, GLuint groups);

/* Copies the planes asked for from the target into the frame: `tile`, which lies in `drawn`. */
bool readback(struct gl_renderer *renderer, const struct frame_request *request,
              const struct view *view, const struct tile *drawn, const struct tile *tile,
              struct frame *frame, struct error *error);

/* Turns a pending GL error into ERROR_DEVICE; `doing` names what was tried. */
bool gpu_check(const char *doing, struct error *error);

#endif
