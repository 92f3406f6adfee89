#include "server/render/gl/paused_tiles.h"

#include <stdlib.h>

#include "server/render/gl/device_internal.h"
#include "server/render/gl/frame_state.h"
#include "server/render/gl/kept.h"
#include "server/render/gl/model.h"
#include "server/render/gl/target.h"

struct paused_tiles *paused_tiles_create(void)
{
    struct paused_tiles *set = calloc(1, sizeof *set);
    if (!set)
        return NULL;
    atomic_init(&set->holders, 1);
    for (int i = 0; i < MAX_PAUSED_TILES; i++)
        set->paused[i].set = set;
    return set;
}

void paused_tiles_release(struct paused_tiles *set)
{
    if (set && atomic_fetch_sub(&set->holders, 1) == 1)
        free(set);
}

bool mesh_is_needed(const struct gl_renderer *r, const struct polygon_mesh *mesh)
{
    for (int i = 0; i < MAX_PAUSED_TILES; i++) {
        struct paused_tile *paused = &r->paused_tiles->paused[i];
        if (context_is_current(&r->context, paused->context) && atomic_load(&paused->is_taken) &&
            paused->model_serial == mesh->model_serial && paused->level == mesh->level)
            return true;
    }
    return false;
}

/* Takes the largest free target, and frees the planes of the other free ones. */
static struct paused_tile *take(struct gl_renderer *r)
{
    struct paused_tile *taken = NULL;
    for (int i = 0; i < MAX_PAUSED_TILES; i++) {
        struct paused_tile *paused = &r->paused_tiles->paused[i], *smaller = paused;
        if (atomic_load(&paused->is_taken))
            continue;
        if (!context_is_current(&r->context, paused->context))
            paused->planes = (struct planes){0};
        paused->context = r->context.number;
        if (!taken || paused->planes.target.width > taken->planes.target.width) {
            smaller = taken;
            taken = paused;
        }
        if (smaller)
            target_finish(&smaller->planes.target);
    }
    if (!taken)
        return NULL;
    /* The previous frame may have been one tile or several. */
    taken->planes.kept.model_serial = 0;
    atomic_fetch_add(&taken->set->holders, 1);
    atomic_store(&taken->is_taken, true);
    return taken;
}

void tile_give_back(struct gl_frame *own)
{
    struct paused_tile *paused = own->paused;
    own->paused = NULL;
    if (!paused)
        return;
    struct paused_tiles *set = paused->set; /* another frame may take it at once */
    atomic_store(&paused->is_taken, false);
    paused_tiles_release(set);
}

void tile_resume(struct gl_renderer *r, struct gl_frame *own)
{
    if (own->paused && context_is_current(&r->context, own->paused->context)) {
        planes_swap(r, &own->paused->planes);
        return;
    }
    /* The tile is new, or what was drawn of it was lost with the device. */
    tile_give_back(own);
    own->stage = TILE_FILL;
    own->part = 0;
}

bool tile_pause(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                struct error *error)
{
    if (!own->paused && !(own->paused = take(r)))
        return error_set(error, ERROR_SERVER,
                         "%d other frames of polygons are being drawn: try again later",
                         MAX_PAUSED_TILES);
    own->paused->model_serial = model->serial;
    own->paused->level = own->work->request->surface.level;
    planes_swap(r, &own->paused->planes);
    return true;
}
