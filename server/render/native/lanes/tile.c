/* Draws a tile: which piece each pixel sees, and where its ray meets the surface (shaders/unsolved.comp.glsl says in
 * which order guesses are tried). */
#include "server/render/native/lanes/entries.h"
#include "server/render/native/lanes/raster.h"
#include "server/render/native/lanes/stages.h"

#include <math.h>
#include <string.h>

#include "server/render/native/denormals.h"
#include "server/render/native/times.h"

/* Number of depth steps by which pieces are sorted before they are drawn. */
enum { DEPTH_STEPS = 1024 };
/* seen.glsl: a slope of this many px of depth per px. */
static const float DOUBT_PX = 4;
static const int BESIDE[4] = {-1, 1, -SEEN_PITCH, SEEN_PITCH};

/* The part of the tile that is asked for, px of the tile. */
struct wanted {
    uint32_t x0, y0, x1, y1;
};

static uint32_t cut_to(uint32_t value, uint32_t low, uint32_t high)
{
    return value < low ? 0 : value > high ? high - low : value - low;
}

/* The pixels of a rectangle of the picture, in px of the tile. */
static struct wanted part_of(const struct tile *tile, const struct tile *rectangle)
{
    uint32_t right = tile->x + tile->width, bottom = tile->y + tile->height;
    return (struct wanted){cut_to(rectangle->x, tile->x, right),
                           cut_to(rectangle->y, tile->y, bottom),
                           cut_to(rectangle->x + rectangle->width, tile->x, right),
                           cut_to(rectangle->y + rectangle->height, tile->y, bottom)};
}

static void begin(const struct native_frame *frame, struct native_tile_room *room, uint32_t number)
{
    const struct tile *around = &frame->around;
    room->tile = (struct tile){(frame->first_x + number % frame->tiles_x) * TILE_WIDTH,
                               (frame->first_y + number / frame->tiles_x) * TILE_HEIGHT, TILE_WIDTH,
                               TILE_HEIGHT};
    int left = (int)room->tile.x - APRON, top = (int)room->tile.y - APRON;
    room->x0 = (int)around->x > left ? (int)around->x - left : 0;
    room->y0 = (int)around->y > top ? (int)around->y - top : 0;
    room->x1 = (int)(around->x + around->width) - left - 1;
    room->y1 = (int)(around->y + around->height) - top - 1;
    room->x1 = room->x1 < TILE_WIDTH + 2 * APRON ? room->x1 : TILE_WIDTH + 2 * APRON - 1;
    room->y1 = room->y1 < SEEN_ROWS ? room->y1 : SEEN_ROWS - 1;
    room->n_strays = room->n_asking = 0;
    room->n_tasks = room->n_local = 0;
}

/* Copies px [first, end) of a row of the tile to a row of the caller's planes. */
static void copy_row(const struct native_planes *to, size_t at,
                     const struct native_tile_planes *from, uint32_t first, uint32_t n)
{
    size_t bytes = n * sizeof(float);
    memcpy(to->depth + at, from->depth + first, bytes);
    for (int k = 0; k < 3; k++) {
        memcpy(to->normal[k] + at, from->normal[k] + first, bytes);
        memcpy(to->shape[k] + at, from->shape[k] + first, bytes);
    }
    memcpy(to->face + at, from->face + first, bytes);
    memcpy(to->u + at, from->u + first, bytes);
    memcpy(to->v + at, from->v + first, bytes);
    memcpy(to->border + at, from->border + first, bytes);
    memcpy(to->node + at, from->node + first, bytes);
    memcpy(to->where + at, from->where + first, bytes);
}

/* Copies to the caller what was met; depth 0 where nothing was. */
static void copy_out(const struct native_frame *frame, const struct native_tile_room *room,
                     const struct wanted *wanted, bool is_empty)
{
    const struct native_planes *planes = frame->planes;
    for (uint32_t y = wanted->y0; y < wanted->y1; y++) {
        uint32_t first = wanted->x0, end = wanted->x1, row = TILE_PLANE_FIRST + y * TILE_WIDTH;
        size_t at =
            (room->tile.y + y - frame->tile.y) * planes->pitch + room->tile.x - frame->tile.x;
        memset(planes->depth + at + first, 0, (end - first) * sizeof(float));
        if (is_empty)
            continue;
        while (first < end && !(room->planes.before[row + first] >= 0))
            first++;
        while (first < end && !(room->planes.before[row + end - 1] >= 0))
            end--;
        if (first < end)
            copy_row(planes, at + first, &room->planes, row + first, end - first);
    }
}

/* --- stage 1 */

/* Steps of depth, the nearest first. They depend on the view alone, so pieces are drawn in the same order whatever
 * else is in the list. In perspective the steps are about logarithmic. */
struct depth_steps {
    bool by_bits;
    float first, per_step;
    uint32_t first_bits, bits_per_step;
};

static uint32_t bits_of(float a)
{
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static struct depth_steps depth_steps_of(const struct native_rays *rays)
{
    struct depth_steps steps = {.first = rays->nearest};
    steps.per_step = (DEPTH_STEPS - 1) / (rays->nearest - rays->farthest);
    /* With near and far far apart, equal steps would put all pieces into the last one. */
    steps.by_bits = rays->perspective && rays->nearest > 16;
    steps.first_bits = bits_of(rays->nearest);
    uint32_t range = steps.first_bits - bits_of(1.0f / 16);
    steps.bits_per_step = rays->nearest > 16 ? range / (DEPTH_STEPS - 1) + 1 : 1;
    return steps;
}

static uint32_t depth_step(const struct depth_steps *steps, float nearest)
{
    if (steps->by_bits) {
        uint32_t bits = bits_of(nearest < 1.0f / 16 ? 1.0f / 16 : nearest);
        return bits > steps->first_bits ? 0 : (steps->first_bits - bits) / steps->bits_per_step;
    }
    float step = (steps->first - nearest) * steps->per_step;
    return step > 0 ? step < DEPTH_STEPS - 1 ? (uint32_t)step : DEPTH_STEPS - 1 : 0;
}

bool LANE_NAME(native_reserve_local)(struct native_tile_room *room, size_t n)
{
    size_t local = room->local_capacity, quad = local, count = local, order = local;
    if (!native_grow(&room->local, &local, n + 2, sizeof(struct native_piece *)) ||
        !native_grow(&room->quad, &quad, n + 2, sizeof(struct native_quad *)) ||
        !native_grow(&room->count, &count, n + 2, sizeof *room->count) ||
        !native_grow(&room->order, &order, n + 2, sizeof *room->order))
        return false;
    room->local_capacity = local;
    return true;
}

/* Lists the tile's quads, roughly front to back. order[k]: the thread that placed quad k. */
static bool list_local(const struct native_frame *frame, struct native_tile_room *room,
                       uint32_t number)
{
    const struct depth_steps steps = depth_steps_of(&frame->rays);
    uint32_t at[DEPTH_STEPS + 1] = {0};
    size_t n = 0;
    for (uint32_t p = 0; p < frame->n_parts; p++)
        n += frame->part[p].first_entry[number + 1] - frame->part[p].first_entry[number];
    if (!LANE_NAME(native_reserve_local)(room, n))
        return false;
    room->n_local = n;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t p = 0; p < frame->n_parts; p++) {
            const struct native_part *part = &frame->part[p];
            const struct native_thread *thread = &frame->thread[part->thread];
            for (uint32_t i = part->first_entry[number]; i < part->first_entry[number + 1]; i++) {
                const struct native_entry *entry = &thread->entry[i];
                uint32_t step = depth_step(&steps, entry->nearest);
                if (pass == 0) {
                    at[step + 1]++;
                    continue;
                }
                uint32_t k = at[step]++;
                room->local[k] = &thread->piece[entry->quad];
                room->quad[k] = &thread->quad[entry->quad];
                room->order[k] = part->thread;
            }
        }
        for (int k = 0; k < DEPTH_STEPS && pass == 0; k++)
            at[k + 1] += at[k];
    }
    return true;
}

static void see(const struct native_frame *frame, struct native_tile_room *room)
{
    memset(room->nearness, 0, sizeof room->nearness);
    for (size_t k = 0; k < room->n_local; k++) {
        enum { AHEAD = 10 }; /* quads are scattered in memory */
        if (k + AHEAD < room->n_local)
            __builtin_prefetch(room->quad[k + AHEAD]);
        LANE_NAME(native_raster)(room, &frame->thread[room->order[k]], room->quad[k], (int)k);
    }
}

/* Sorts the wanted pixels that show something by their pieces (counting sort). */
static void sort_by_piece(struct native_tile_room *room, const struct wanted *wanted)
{
    uint32_t *count = room->count;
    memset(count, 0, (room->n_local + 2) * sizeof *count);
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t y = wanted->y0; y < wanted->y1; y++) {
            for (uint32_t x = wanted->x0; x < wanted->x1; x += LANES) {
                uint32_t pixel = y * TILE_WIDTH + x;
                int at = native_seen_at(pixel);
                unsigned seen = v_bits(v_less(v_float(0), v_load(room->nearness + at)));
                for (seen &= v_first(wanted->x1 - x); seen; seen &= seen - 1) {
                    int k = __builtin_ctz(seen);
                    uint32_t *next = &count[room->piece[at + k] + 2 - pass];
                    if (pass == 1) {
                        room->pixel[*next] = (uint16_t)(pixel + (uint32_t)k);
                        room->guess[*next] = room->place[at + k];
                    }
                    (*next)++;
                }
            }
        }
        for (size_t k = 1; k <= room->n_local && pass == 0; k++)
            count[k + 1] += count[k];
    }
}

/* --- stage 2, after its first pass */

static bool reserve_tasks(struct native_tile_room *room, size_t n)
{
    size_t task = room->task_capacity, met = task, active = task;
    if (!native_grow(&room->task, &task, n, sizeof *room->task) ||
        !native_grow(&room->met, &met, n, sizeof *room->met) ||
        !native_grow(&room->active, &active, n, sizeof *room->active))
        return false;
    room->task_capacity = task;
    return true;
}

/* Adds a task for a pixel: to start from what is seen at `at`. */
static void add_task(const struct native_frame *frame, struct native_tile_room *room,
                     uint32_t asker, uint32_t pixel, int at)
{
    const struct native_piece *piece = room->local[room->piece[at]];
    struct native_task *task = &room->task[room->n_tasks++];
    *task = (struct native_task){.asker = asker,
                                 .before = before_of(&frame->rays, room->nearness[at]),
                                 .at_px = {room->tile.x + pixel % TILE_WIDTH + 0.5,
                                           room->tile.y + pixel / TILE_WIDTH + 0.5}};
    native_begin_on(frame->model, task, piece, room->place[at]);
}

/* Whether nothing lies in front of a hit by more than a slope, nor on both sides of it by a pixel's depth
 * (seen.glsl). */
static bool is_settled(const struct native_rays *rays, const struct native_tile_room *room, int at,
                       float before)
{
    float px = native_pixel_units(rays, rays->far - before), beside[4];
    for (int k = 0; k < 4; k++)
        beside[k] = before_of(rays, room->nearness[at + BESIDE[k]]);
    float in_front = before + DOUBT_PX * px, on_both = before + px;
    for (int k = 0; k < 4; k++)
        if (beside[k] > in_front)
            return false;
    return !(beside[0] > on_both && beside[1] > on_both) &&
           !(beside[2] > on_both && beside[3] > on_both);
}

/* Writes what the tasks have found. */
static void write_asking(const struct native_frame *frame, struct native_tile_room *room)
{
    enum { AT_ONCE = 256 };
    uint16_t pixel[AT_ONCE];
    const struct native_met *met[AT_ONCE];
    size_t n = 0;
    for (uint32_t i = 0; i < room->n_asking; i++) {
        const struct native_asking *asking = &room->asking[i];
        if (asking->has_hit || !asking->best.found)
            continue;
        pixel[n] = asking->pixel;
        met[n++] = &asking->best;
        if (n == AT_ONCE) {
            LANE_NAME(native_write)(frame, room, pixel, met, n);
            n = 0;
        }
    }
    LANE_NAME(native_write)(frame, room, pixel, met, n);
}

/* Solves strays from their own guess; those that are not settled then are tried again. */
static bool solve_strays(const struct native_frame *frame, struct native_tile_room *room)
{
    if (!reserve_tasks(room, room->n_strays))
        return false;
    for (uint32_t i = 0; i < room->n_strays; i++)
        add_task(frame, room, i, room->stray[i], native_seen_at(room->stray[i]));
    LANE_NAME(native_meet)(frame, room);
    for (uint32_t i = 0; i < room->n_strays; i++)
        room->asking[i] = (struct native_asking){.pixel = room->stray[i], .best = room->met[i]};
    room->n_asking = room->n_strays;
    uint32_t n = 0;
    for (uint32_t i = 0; i < room->n_asking; i++) {
        struct native_asking *asking = &room->asking[i];
        bool settled =
            asking->best.found &&
            is_settled(&frame->rays, room, native_seen_at(asking->pixel), asking->best.before);
        if (!settled)
            room->stray[n++] = (uint16_t)i;
        asking->has_hit = !settled;
    }
    write_asking(frame, room);
    for (uint32_t i = 0; i < n; i++) {
        room->asking[i] = room->asking[room->stray[i]];
        room->asking[i].has_hit = false;
    }
    room->n_asking = n;
    return true;
}

/* Adds empty pixels beside ones that are not, and pixels whose hit lies behind what is seen beside it
 * (recheck.comp.glsl). */
static void find_doubtful(const struct native_frame *frame, struct native_tile_room *room,
                          const struct wanted *wanted)
{
    const struct native_rays *rays = &frame->rays;
    for (uint32_t y = wanted->y0; y < wanted->y1; y++) {
        for (uint32_t x = wanted->x0; x < wanted->x1; x += LANES) {
            uint32_t pixel = y * TILE_WIDTH + x;
            const float *seen = room->nearness + native_seen_at(pixel);
            vfloat before = v_load(room->planes.before + TILE_PLANE_FIRST + pixel),
                   own = v_load(seen);
            vfloat left = v_load(seen - 1), right = v_load(seen + 1);
            vfloat above = v_load(seen - SEEN_PITCH), below = v_load(seen + SEEN_PITCH);
            vfloat front = v_max(v_max(left, right), v_max(above, below));
            vfloat px = (rays->far - before) * rays->slope_px + rays->start_px;
            vfloat both = v_max(v_min(left, right), v_min(above, below));
            vmask is_hit = v_at_most(v_float(0), before);
            vmask is_behind = v_less(before + DOUBT_PX * px, v_before(rays, front)) |
                              v_less(before + px, v_before(rays, both));
            vmask is_beside = v_at_most(own, v_float(0)) & v_less(v_float(0), front);
            unsigned bits = v_bits((is_hit & is_behind) | (v_not(is_hit) & is_beside));
            for (bits &= v_first(wanted->x1 - x); bits; bits &= bits - 1) {
                uint32_t p = pixel + (uint32_t)__builtin_ctz(bits);
                struct native_asking *asking = &room->asking[room->n_asking++];
                *asking = (struct native_asking){.pixel = (uint16_t)p};
                asking->best.before = room->planes.before[TILE_PLANE_FIRST + p];
                asking->has_hit = asking->best.before >= 0;
                asking->best.found = asking->has_hit;
            }
        }
    }
}

/* Tries those guesses beside a pixel that may lead to something nearer than its hit. */
static void ask_beside(const struct native_frame *frame, struct native_tile_room *room, uint32_t i)
{
    const struct native_asking *asking = &room->asking[i];
    int at = native_seen_at(asking->pixel);
    for (int k = 0; k < 4; k++) {
        float nearness = room->nearness[at + BESIDE[k]];
        if (nearness > 0 &&
            (!asking->best.found || before_of(&frame->rays, nearness) > asking->best.before))
            add_task(frame, room, i, asking->pixel, at + BESIDE[k]);
    }
}

/* Tries the guesses around each pixel; the nearest place wins. */
static bool ask_around(const struct native_frame *frame, struct native_tile_room *room)
{
    if (!reserve_tasks(room, 4 * (size_t)room->n_asking))
        return false;
    room->n_tasks = 0;
    for (uint32_t i = 0; i < room->n_asking; i++)
        ask_beside(frame, room, i);
    LANE_NAME(native_meet)(frame, room);
    for (size_t k = 0; k < room->n_tasks; k++) {
        struct native_asking *asking = &room->asking[room->task[k].asker];
        const struct native_met *met = &room->met[k];
        if (!met->found || (asking->best.found && asking->best.before >= met->before))
            continue;
        asking->best = *met;
        asking->has_hit = false;
    }
    write_asking(frame, room);
    return true;
}

/* Lists pixels that see a piece but have met nothing: they may be in gaps. */
static bool list_gaps(const struct native_frame *frame, struct native_thread *thread)
{
    const struct native_tile_room *room = thread->tile;
    if (!native_grow(&thread->gap, &thread->gap_capacity, thread->n_gaps + room->n_asking,
                     sizeof *thread->gap))
        return false;
    for (uint32_t i = 0; i < room->n_asking; i++) {
        const struct native_asking *asking = &room->asking[i];
        if (asking->best.found || !(room->nearness[native_seen_at(asking->pixel)] > 0))
            continue;
        uint32_t x = room->tile.x - frame->tile.x + asking->pixel % TILE_WIDTH;
        uint32_t y = room->tile.y - frame->tile.y + asking->pixel / TILE_WIDTH;
        thread->gap[thread->n_gaps++] = x | y << 16;
    }
    return true;
}

/* False: no memory. */
static bool draw(const struct native_frame *frame, struct native_thread *thread, uint32_t number,
                 struct native_times *times)
{
    struct native_tile_room *room = thread->tile;
    begin(frame, room, number);
    const struct wanted wanted = part_of(&room->tile, &frame->tile);
    uint64_t at_us = times_now();
    if (!list_local(frame, room, number))
        return false;
    if (!room->n_local) {
        copy_out(frame, room, &wanted, true);
        return true;
    }
    see(frame, room);
    times_add(&times->raster_us, &at_us);
    sort_by_piece(room, &wanted);
    times_add(&times->sort_us, &at_us);
    for (int i = 0; i < TILE_PLANE; i++) {
        room->planes.before[i] = -1;
        room->planes.depth[i] = 0;
    }
    LANE_NAME(native_evaluate)(frame, room);
    times_add(&times->evaluate_us, &at_us);
    if (!solve_strays(frame, room))
        return false;
    find_doubtful(frame, room, &wanted);
    bool ok = ask_around(frame, room) && list_gaps(frame, thread);
    times_add(&times->retry_us, &at_us);
    copy_out(frame, room, &wanted, false);
    times_add(&times->copy_us, &at_us);
    return ok;
}

void LANE_NAME(native_tile)(struct native_frame *frame, struct native_thread *thread,
                            uint32_t number)
{
    denormals saved = denormals_flush();
    if (!draw(frame, thread, number, &thread->times))
        __atomic_store_n(&frame->out_of_memory, true, __ATOMIC_RELAXED);
    denormals_restore(saved);
}

/* --- stage 2, pixels in gaps */

/* Whether there are hits on two opposite sides. Pixels in gaps do not count; they have no hit yet. */
static bool is_between(const struct native_frame *frame, uint32_t x, uint32_t y)
{
    static const int aside[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    const struct native_planes *planes = frame->planes;
    if (x == 0 || y == 0 || x + 1 >= frame->tile.width || y + 1 >= frame->tile.height) {
        /* At the rim one of the two sides may be missing. */
        bool across = x > 0 && x + 1 < frame->tile.width,
             down = y > 0 && y + 1 < frame->tile.height;
        const float *at = planes->depth + y * planes->pitch + x;
        return (across && at[-1] > 0 && at[1] > 0) ||
               (down && *(at - planes->pitch) > 0 && at[planes->pitch] > 0);
    }
    for (int k = 0; k < 4; k++) {
        const float *at = planes->depth + y * planes->pitch + x;
        ptrdiff_t step = aside[k][1] * (ptrdiff_t)planes->pitch + aside[k][0];
        if (at[step] > 0 && at[-step] > 0)
            return true;
    }
    return false;
}

/* Tries all of the surface that may lie on the pixel's ray. False: no memory. */
static bool solve_gap(const struct native_frame *frame, struct native_thread *thread, uint32_t at,
                      struct error *error)
{
    struct native_tile_room *room = thread->tile;
    uint32_t x = frame->tile.x + (at & 0xffff), y = frame->tile.y + (at >> 16);
    const struct tile one = {x, y, 1, 1};
    thread->grids.n_guesses = 0;
    if (!patch_grids_guess(&thread->grids, frame->model->tables, &frame->model->clusters,
                           frame->view, &one, error) ||
        !reserve_tasks(room, thread->grids.n_guesses))
        return false;
    room->tile = (struct tile){x - x % TILE_WIDTH, y - y % TILE_HEIGHT, TILE_WIDTH, TILE_HEIGHT};
    room->n_tasks = thread->grids.n_guesses;
    for (size_t k = 0; k < room->n_tasks; k++) {
        const struct guess *guess = &thread->grids.guess[k];
        const struct limit_node *node = &frame->model->tables->nodes[guess->node];
        int level = guess->where & 63;
        double s = (guess->where >> 6 & 8191) * (2 / 8191.0),
               t = (guess->where >> 19) * (2 / 8191.0);
        struct native_task *task = &room->task[k];
        double x_of = s * (node->kind == LIMIT_STRIP ? 1 : native_power(-level));
        double y_of = t * native_power(-level);
        *task = (struct native_task){.node = guess->node,
                                     .before = frame->rays.far - guess->depth,
                                     .at_px = {x + 0.5, y + 0.5}};
        native_begin_at(frame->model, task, x_of < 1 ? x_of : 1, y_of < 1 ? y_of : 1);
    }
    LANE_NAME(native_meet)(frame, room);
    const struct native_met *best = NULL;
    for (size_t k = 0; k < room->n_tasks; k++)
        if (room->met[k].found && (!best || room->met[k].before > best->before))
            best = &room->met[k];
    const uint16_t pixel = (uint16_t)(y % TILE_HEIGHT * TILE_WIDTH + x % TILE_WIDTH);
    if (!best)
        return true;
    LANE_NAME(native_write)(frame, room, &pixel, &best, 1);
    copy_row(frame->planes, (y - frame->tile.y) * frame->planes->pitch + x - frame->tile.x,
             &room->planes, TILE_PLANE_FIRST + pixel, 1);
    return true;
}

void LANE_NAME(native_gaps)(struct native_frame *frame, struct native_thread *thread)
{
    denormals saved = denormals_flush();
    struct error error;
    size_t n = 0;
    for (size_t i = 0; i < thread->n_gaps; i++)
        if (is_between(frame, thread->gap[i] & 0xffff, thread->gap[i] >> 16))
            thread->gap[n++] = thread->gap[i];
    thread->n_gaps = n;
    for (size_t i = 0; i < n && n <= NATIVE_MAX_GAPS; i++)
        if (!solve_gap(frame, thread, thread->gap[i], &error))
            frame->out_of_memory = true;
    denormals_restore(saved);
}
