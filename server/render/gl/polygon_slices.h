/* Frames of polygons, slice by slice: meshes of millions of triangles keep a software device busy
 * for seconds, and others are drawn in between. What a frame has drawn of its tile stays in its
 * planes, which are set aside meanwhile, so that the picture is that of one stroke. GL thread,
 * where nothing else is said. */
#ifndef SHEEN_RENDER_GL_POLYGON_SLICES_H
#define SHEEN_RENDER_GL_POLYGON_SLICES_H

#include <stdatomic.h>

#include "server/render/gl/context/context.h"
#include "server/render/gl/kept.h"
#include "server/render/view.h"

struct gl_frame;
struct polygon_mesh;

/* What a tile of polygons goes through. */
enum tile_stage { TILE_FILL, TILE_SHADE, TILE_EDGES, TILE_WHOLE };

/* What a frame of polygons has drawn of its tile, while others are drawn between its steps. */
enum { MAX_PAUSED_TILES = 24 };
struct paused_tile {
    struct planes planes;
    context_number context; /* of the planes */
    uint64_t model_serial;  /* the device must keep this model's mesh of this level meanwhile */
    uint32_t level;
    atomic_bool is_taken; /* by a frame, which gives it back on any thread */
    struct paused_tiles *set;
};

/* On the heap, since a frame may give its tile back when the renderer has gone. */
struct paused_tiles {
    atomic_uint holders; /* the renderer, and the frames with a paused tile; the last one frees the
                            set */
    struct paused_tile paused[MAX_PAUSED_TILES];
};

/* NULL when memory is short. Released once by the renderer, any thread. */
struct paused_tiles *paused_tiles_create(void);
void paused_tiles_release(struct paused_tiles *set);
/* Takes into use what the frame has drawn of its tile, if anything. */
void tile_resume(struct gl_renderer *r, struct gl_frame *own);
/* Keeps what is drawn until the frame's next step: others may use the planes meanwhile. */
bool tile_pause(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                struct error *error);
/* Gives the planes back: the frame needs what it has drawn no longer. Any thread. */
void tile_give_back(struct gl_frame *own);
/* Is a frame under way that is drawn of this mesh? */
bool mesh_is_needed(const struct gl_renderer *r, const struct polygon_mesh *mesh);

/* The next part of a tile of polygons, as much as a step may take. *is_whole: it was the last, and
 * stands in the frame. */
bool draw_polygons(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                   const struct view *view, const struct tile *drawn, struct frame *frame,
                   bool *is_whole, struct error *error);

#endif
