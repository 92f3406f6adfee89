#include "server/render/native/native.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "server/base/processors.h"
#include "server/render/native/frame.h"
#include "server/render/native/team.h"
#include "server/render/native/tile.h"
#include "server/render/native/times.h"

enum { HUGE_PAGE = 2 << 20, MOST_LANES = 16 };

struct native_device {
    const struct native_set *set;
    struct native_team *team;
    struct native_thread *thread; /* [n_threads] */
    unsigned n_threads;
    /* For each grid: positions of its vertices on a piece, row by row, and one vector more. */
    float *grid_places;
    const float *grid_s[GRID_SHAPES], *grid_t[GRID_SHAPES];
    uint32_t *first_entry; /* per part: where each tile's entries begin */
    size_t first_entry_capacity;
    struct native_frame drawn; /* the last one */
};

void *native_allocate(size_t bytes)
{
    size_t align = bytes < HUGE_PAGE ? 64 : HUGE_PAGE;
    bytes = (bytes + align - 1) & ~(align - 1);
    void *memory = aligned_alloc(align, bytes);
    if (memory && align == HUGE_PAGE)
        madvise(memory, bytes, MADV_HUGEPAGE); /* a hint */
    return memory;
}

bool native_grow(void *pointer, size_t *capacity, size_t n, size_t size)
{
    if (n <= *capacity)
        return true;
    size_t room = n + n / 4 + 64, bytes = room * size;
    if (room < n || bytes / size != room)
        return false;
    void *grown = native_allocate(bytes), *before;
    if (!grown)
        return false;
    memcpy(&before, pointer, sizeof before);
    if (before)
        memcpy(grown, before, *capacity * size);
    free(before);
    memcpy(pointer, &grown, sizeof grown);
    *capacity = room;
    return true;
}

static void frame_of(const struct limit_tables *tables, const struct limit_node *node,
                     float axes[3][3])
{
    const float *q = tables->heads[node - tables->nodes].frame;
    float x = q[0], y = q[1], z = q[2], w = q[3];
    const float matrix[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(axes, matrix, sizeof matrix);
}

void native_see_node(const struct native_frame *frame, const struct limit_node *node,
                     struct native_seen_node *seen)
{
    static const float unturned[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct native_rays *rays = &frame->rays;
    view_transform(frame->view, node->origin, seen->at);
    seen->before = frame->view->far - seen->at[2];
    seen->is_turned = node->kind == LIMIT_CORNER;
    if (!seen->is_turned) {
        memcpy(seen->axes, unturned, sizeof unturned);
        memcpy(seen->camera, rays->axis, sizeof rays->axis);
        return;
    }
    frame_of(frame->model->tables, node, seen->axes);
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++)
            seen->camera[a][k] = rays->axis[a][0] * seen->axes[0][k] +
                                 rays->axis[a][1] * seen->axes[1][k] +
                                 rays->axis[a][2] * seen->axes[2][k];
}

void native_borders_of(const struct limit_node *node, struct native_borders *borders)
{
    unsigned last = (1u << node->depth) - 1, x = node->cell & 0xffff, y = node->cell >> 16;
    const unsigned cells[4] = {y, last - x, last - y, x};
    for (unsigned e = 0; e < 4; e++) {
        unsigned edge = (e + node->rotation) & 3, border = node->borders >> 4 * edge & 15;
        borders->is[e] = border != 0;
        borders->beyond[e] = (float)cells[edge];
        borders->rounding[e] =
            border == LIMIT_BORDER_SHARP ? 0 : (float)native_power(node->depth - (int)border);
    }
}

/* --- */

static bool make_grids(struct native_device *device)
{
    size_t total = 0;
    for (int pass = 0; pass < 2; pass++) {
        float *at = device->grid_places;
        for (int g = 0; g < GRID_SHAPES; g++) {
            int across = grid_cells[g / GRID_SIDES], down = grid_cells[g % GRID_SIDES];
            int n = (across + 1) * (down + 1);
            total += pass ? 0 : 2 * (size_t)(n + MOST_LANES);
            if (!pass)
                continue;
            device->grid_s[g] = at;
            device->grid_t[g] = at + n + MOST_LANES;
            for (int i = 0; i < n + MOST_LANES; i++, at++) {
                int k = i < n ? i : n - 1;
                at[0] = (float)(k % (across + 1)) / (float)across;
                at[n + MOST_LANES] = (float)(k / (across + 1)) / (float)down;
            }
            at += n + MOST_LANES;
        }
        if (!pass)
            device->grid_places = malloc(total * sizeof *device->grid_places);
        if (!device->grid_places)
            return false;
    }
    return true;
}

static bool make_threads(struct native_device *device)
{
    device->thread = calloc(device->n_threads, sizeof *device->thread);
    for (unsigned i = 0; device->thread && i < device->n_threads; i++) {
        size_t n = 0;
        device->thread[i].number = i;
        if (!native_grow(&device->thread[i].tile, &n, 1, sizeof *device->thread[i].tile))
            return false;
        memset(device->thread[i].tile, 0, sizeof *device->thread[i].tile);
    }
    return device->thread;
}

struct native_device *native_device_create(const struct native_options *options,
                                           struct error *error)
{
    const struct native_set *set = native_set_find(options->set);
    if (!set) {
        const struct native_set *widest = native_set_find(NULL);
        error_set(error, ERROR_DEVICE,
                  "this processor lacks the instructions %s of --native-isa; the widest that it "
                  "has and sheen draws by: %s",
                  options->set ? options->set : "v2", widest ? widest->name : "none");
        return NULL;
    }
    struct native_device *device = calloc(1, sizeof *device);
    if (device) {
        unsigned n = options->n_threads ? options->n_threads : processors_available("");
        device->set = set;
        device->n_threads = n > NATIVE_MAX_THREADS ? NATIVE_MAX_THREADS : n;
    }
    if (device && make_grids(device) && make_threads(device))
        device->team = native_team_create(device->n_threads);
    if (device && device->team)
        return device;
    error_set(error, ERROR_SERVER, "out of memory or threads for the native device");
    native_device_destroy(device);
    return NULL;
}

static void finish_thread(struct native_thread *thread)
{
    patch_grids_finish(&thread->grids);
    free(thread->piece);
    free(thread->quad);
    free(thread->nearest);
    free(thread->vertex);
    free(thread->triangle);
    free(thread->entry);
    free(thread->gap);
    free(thread->rays);
    if (thread->tile) {
        free(thread->tile->local);
        free(thread->tile->quad);
        free(thread->tile->count);
        free(thread->tile->order);
        free(thread->tile->task);
        free(thread->tile->met);
        free(thread->tile->active);
    }
    free(thread->tile);
}

void native_device_destroy(struct native_device *device)
{
    if (!device)
        return;
    native_team_destroy(device->team);
    for (unsigned i = 0; device->thread && i < device->n_threads; i++)
        finish_thread(&device->thread[i]);
    free(device->thread);
    free(device->grid_places);
    free(device->first_entry);
    free(device);
}

const char *native_device_name(const struct native_device *device)
{
    return device->set->words;
}

const struct native_set *native_device_set(const struct native_device *device)
{
    return device->set;
}

const struct native_programs *native_device_programs(const struct native_device *device)
{
    return &device->set->programs;
}

void native_device_run(struct native_device *device, void (*work)(void *owner, unsigned number),
                       void *owner)
{
    native_team_run(device->team, work, owner);
}

struct rows {
    uint32_t n, next;
    void (*work)(void *owner, uint32_t first, uint32_t end);
    void *owner;
};

static void do_rows(void *owner, unsigned number)
{
    struct rows *rows = owner;
    (void)number;
    for (uint32_t first;
         (first = __atomic_fetch_add(&rows->next, NATIVE_BAND, __ATOMIC_RELAXED)) < rows->n;)
        rows->work(rows->owner, first,
                   rows->n - first < NATIVE_BAND ? rows->n : first + NATIVE_BAND);
}

void native_device_rows(struct native_device *device, uint32_t n_rows,
                        void (*work)(void *owner, uint32_t first, uint32_t end), void *owner)
{
    struct rows rows = {n_rows, 0, work, owner};
    native_team_run(device->team, do_rows, &rows);
}

bool native_device_left_gaps(const struct native_device *device)
{
    return device->drawn.left_gaps;
}

const struct native_frame *native_device_drawn(const struct native_device *device)
{
    return &device->drawn;
}

unsigned native_device_threads(const struct native_device *device)
{
    return device->n_threads;
}

struct native_thread *native_device_thread(struct native_device *device, unsigned number)
{
    return &device->thread[number];
}

void native_rays_init(struct native_rays *rays, const struct view *view)
{
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++)
            rays->axis[a][k] = (float)view->axis[a][k];
    rays->slope_px = view->perspective ? (float)view->units_per_px : 0;
    rays->start_px = view->perspective ? 0 : (float)view->units_per_px;
    rays->centre_px[0] = (float)view->centre_px[0];
    rays->centre_px[1] = (float)view->centre_px[1];
    rays->far = (float)view->far;
    rays->perspective = view->perspective;
    double range = view->far - view->near;
    rays->nearest = (float)(view->perspective ? range / view->near : range);
    rays->farthest = 0;
}

/* Sets the tile with a pixel around it, inside the picture, and which tiles of the picture it takes. */
static void set_tiles(struct native_frame *frame)
{
    const struct tile *tile = &frame->tile;
    uint32_t right = tile->x + tile->width, bottom = tile->y + tile->height;
    struct tile *around = &frame->around;
    around->x = tile->x - (tile->x > 0);
    around->y = tile->y - (tile->y > 0);
    around->width = right + (right < frame->view->width_px) - around->x;
    around->height = bottom + (bottom < frame->view->height_px) - around->y;
    frame->first_x = tile->x / TILE_WIDTH;
    frame->first_y = tile->y / TILE_HEIGHT;
    frame->tiles_x = (right - 1) / TILE_WIDTH - frame->first_x + 1;
    frame->tiles_y = (bottom - 1) / TILE_HEIGHT - frame->first_y + 1;
}

/* Sets the parts of the model, and reserves room for the start of each tile's entries. */
static bool set_parts(struct native_frame *frame, struct native_device *device)
{
    size_t n = frame->model->clusters.n, per_part = (n + MAX_PARTS - 1) / MAX_PARTS;
    size_t row = (size_t)frame->tiles_x * frame->tiles_y + 2;
    frame->clusters_per_part = per_part;
    frame->n_parts = n ? (uint32_t)((n + per_part - 1) / per_part) : 0;
    if (!native_grow(&device->first_entry, &device->first_entry_capacity, row * frame->n_parts,
                     sizeof *device->first_entry))
        return false;
    for (uint32_t p = 0; p < frame->n_parts; p++)
        frame->part[p].first_entry = device->first_entry + p * row;
    return true;
}

/* Chooses the pieces of a part, and places them. */
static void do_part(struct native_frame *frame, struct native_thread *thread, uint32_t number)
{
    struct error error;
    size_t first = number * frame->clusters_per_part;
    uint64_t at = times_now(), n_vertices = 0;
    bool ok = patch_grids_choose_part(&thread->grids, frame->model->tables, &frame->model->clusters,
                                      first, frame->clusters_per_part, frame->view, &frame->around,
                                      &n_vertices, &error);
    times_add(&thread->times.choose_us, &at);
    if (!ok && error.kind == ERROR_SERVER)
        __atomic_store_n(&frame->out_of_memory, true, __ATOMIC_RELAXED);
    n_vertices += __atomic_fetch_add(&frame->n_vertices, n_vertices, __ATOMIC_RELAXED);
    if (n_vertices > GRIDS_MAX_VERTICES)
        __atomic_store_n(&frame->too_many, true, __ATOMIC_RELAXED);
    if (ok && !__atomic_load_n(&frame->too_many, __ATOMIC_RELAXED))
        frame->set->pieces(frame, thread, number);
    times_add(&thread->times.quads_us, &at);
}

static bool has_failed(const struct native_frame *frame)
{
    return __atomic_load_n(&frame->out_of_memory, __ATOMIC_RELAXED) ||
           __atomic_load_n(&frame->too_many, __ATOMIC_RELAXED);
}

void native_forget_patches(struct native_thread *thread)
{
    for (int i = 0; i < TILE_PATCHES; i++)
        thread->tile->patch[i].node = UINT32_MAX;
}

struct job {
    struct native_frame frame;
    struct native_team *team;
};

static void work(void *owner, unsigned number)
{
    struct job *job = owner;
    struct native_frame *frame = &job->frame;
    struct native_thread *thread = &frame->thread[number];
    uint32_t n_tiles = frame->tiles_x * frame->tiles_y, k;
    thread->n_quads = thread->n_vertices = thread->n_triangles = 0;
    thread->n_entries = thread->n_gaps = 0;
    native_forget_patches(thread); /* they may belong to another model */
    thread->times = (struct native_times){0};
    while ((k = __atomic_fetch_add(&frame->next_part, 1, __ATOMIC_RELAXED)) < frame->n_parts &&
           !has_failed(frame))
        do_part(frame, thread, k);
    native_team_meet(job->team);
    while (!has_failed(frame) &&
           (k = __atomic_fetch_add(&frame->next_tile, 1, __ATOMIC_RELAXED)) < n_tiles)
        frame->set->tile(frame, thread, k);
}

static int compare(const void *a, const void *b)
{
    uint32_t p, q;
    memcpy(&p, a, sizeof p);
    memcpy(&q, b, sizeof q);
    p = p << 16 | p >> 16; /* compares rows first */
    q = q << 16 | q >> 16;
    return p < q ? -1 : p > q;
}

/* Solves all threads' pixels that may be in gaps, in one order. */
static bool solve_gaps(struct native_frame *frame)
{
    struct native_thread *first = &frame->thread[0];
    size_t n = 0;
    for (unsigned i = 0; i < frame->n_threads; i++)
        n += frame->thread[i].n_gaps;
    if (!n)
        return true;
    if (!native_grow(&first->gap, &first->gap_capacity, n, sizeof *first->gap))
        return false;
    for (unsigned i = 1; i < frame->n_threads; i++) {
        const struct native_thread *thread = &frame->thread[i];
        if (thread->n_gaps)
            memcpy(first->gap + first->n_gaps, thread->gap, thread->n_gaps * sizeof *thread->gap);
        first->n_gaps += thread->n_gaps;
    }
    qsort(first->gap, n, sizeof *first->gap, compare);
    frame->set->gaps(frame, first);
    frame->left_gaps = first->n_gaps > NATIVE_MAX_GAPS;
    return true;
}

static void add_times(const struct native_frame *frame, struct native_times *times)
{
    *times = (struct native_times){0};
    for (unsigned i = 0; i < frame->n_threads; i++) {
        const struct native_times *own = &frame->thread[i].times;
        times->choose_us += own->choose_us / 1000;
        times->quads_us += own->quads_us / 1000;
        times->raster_us += own->raster_us / 1000;
        times->sort_us += own->sort_us / 1000;
        times->evaluate_us += own->evaluate_us / 1000;
        times->retry_us += own->retry_us / 1000;
        times->copy_us += own->copy_us / 1000;
        times->gaps_us += own->gaps_us / 1000;
    }
}

bool native_draw(struct native_device *device, struct native_model *model, const struct view *view,
                 const struct tile *tile, const struct native_planes *planes,
                 struct native_times *times, struct error *error)
{
    struct job job = {.team = device->team};
    struct native_frame *frame = &job.frame;
    *frame = (struct native_frame){.model = model,
                                   .set = device->set,
                                   .view = view,
                                   .tile = *tile,
                                   .planes = planes,
                                   .thread = device->thread,
                                   .n_threads = device->n_threads,
                                   .grid_s = device->grid_s,
                                   .grid_t = device->grid_t};
    native_model_turn(model);
    native_rays_init(&frame->rays, view);
    set_tiles(frame);
    if (set_parts(frame, device)) {
        native_team_run(device->team, work, &job);
        uint64_t at = times_now();
        frame->out_of_memory = frame->out_of_memory || (!frame->too_many && !solve_gaps(frame));
        times_add(&frame->thread[0].times.gaps_us, &at);
        if (times)
            add_times(frame, times);
    } else {
        frame->out_of_memory = true;
    }
    device->drawn = *frame;
    if (frame->out_of_memory)
        return error_set(error, ERROR_SERVER, "out of memory for a frame");
    return !frame->too_many || patch_grids_too_many(error);
}
