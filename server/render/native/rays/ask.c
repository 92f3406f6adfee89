/* Chooses where rays of pixels start, and meets them with the surface. */
#include "server/render/native/rays/rays.h"

#include <assert.h>
#include <string.h>

#include "server/render/native/denormals.h"

/* A ray that meets nothing, though a piece lies at its point, tries the hits of its four neighbours in the pixel in
 * turn, in BESIDE_ROUNDS rounds: in the second, neighbours may have found theirs in the first. */
enum { BESIDE_ROUNDS = 2, BESIDE = 4 };
/* A piece beside a ray's point counts if it lies in front of the piece there by so many px of depth. */
static const float IN_FRONT_PX = 0.5f;

static const float EDGE_RAYS[][2] = {
#include "edge_rays.inc" /* of shaders/rounded.glsl */
};
static_assert(sizeof EDGE_RAYS / sizeof *EDGE_RAYS == NATIVE_MAX_RAYS, "a place for each ray");

static void add_task(struct native_ray_room *room, const struct native_ray_task *begin,
                     uint32_t ray)
{
    struct native_ray_task *task = &room->task[room->n_tasks++];
    *task = *begin;
    task->ray = ray;
}

static void meet_tasks(const struct native_frame *frame, struct native_thread *thread)
{
    frame->set->meet_rays(frame, thread->tile, thread->rays);
    thread->rays->n_tasks = 0;
}

static void ask_on(const struct native_frame *frame, struct native_thread *thread)
{
    native_group_pieces(frame, thread->tile, thread->rays);
    meet_tasks(frame, thread);
}

/* Tries the pieces beside rays where they lie in front of what the rays have met. A ray that has not yet met the piece
 * at its point may still do so from its neighbours' hits, so that piece's depth counts. */
static void ask_bulges(const struct native_frame *frame, struct native_thread *thread)
{
    struct native_ray_room *room = thread->rays;
    const struct native_rays *rays = &frame->rays;
    for (uint32_t ray = 0; ray < room->n_rays; ray++) {
        float nearness = room->beside.nearness[ray];
        if (!(nearness > 0))
            continue;
        float z = native_ray_depth(rays, nearness), own = room->z[ray];
        if (own == RAYS_FARTHEST && room->on.nearness[ray] > 0)
            own = native_ray_depth(rays, room->on.nearness[ray]);
        if (z < own - IN_FRONT_PX * native_pixel_units(rays, z))
            native_ray_start(frame, thread->tile, room, &room->beside, ray);
    }
    meet_tasks(frame, thread);
}

/* The rays of a pixel that meet nothing, though a piece lies at their points. */
static unsigned unmet_of(const struct native_ray_room *room, uint32_t pixel)
{
    uint32_t first = pixel * room->rays_per_px;
    unsigned unmet = 0;
    for (uint32_t k = 0; k < room->rays_per_px; k++) {
        bool is = !(room->z[first + k] < RAYS_FARTHEST) && room->on.nearness[first + k] > 0;
        unmet |= is ? 1u << k : 0;
    }
    return unmet;
}

/* Rays without a hit start from the k-th ray beside them that had a hit when room->asks was set. */
static void ask_beside(const struct native_frame *frame, struct native_ray_room *room, int side,
                       int k)
{
    static const int steps[BESIDE][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (uint32_t i = 0; i < room->n_pixels; i++) {
        unsigned unmet = room->asks[i];
        uint32_t first = i * room->rays_per_px;
        for (unsigned left = unmet & unmet_of(room, i); left; left &= left - 1) {
            int part = __builtin_ctz(left);
            int x = part % side + steps[k][0], y = part / side + steps[k][1];
            if (x < 0 || y < 0 || x >= side || y >= side)
                continue;
            uint32_t from = first + (uint32_t)(y * side + x);
            if (unmet >> (y * side + x) & 1 || !(room->z[from] < RAYS_FARTHEST))
                continue;
            const struct native_ray_task begin = {
                .at = room->met[from], .px = native_pixel_units(&frame->rays, room->z[from])};
            add_task(room, &begin, first + (uint32_t)part);
        }
    }
}

static void ask_again(const struct native_frame *frame, struct native_thread *thread, int side)
{
    struct native_ray_room *room = thread->rays;
    for (int i = 0; i < BESIDE_ROUNDS; i++) {
        for (uint32_t p = 0; p < room->n_pixels; p++)
            room->asks[p] = unmet_of(room, p);
        for (int k = 0; k < BESIDE; k++) {
            ask_beside(frame, room, side, k);
            meet_tasks(frame, thread);
        }
    }
}

/* --- pixels */

uint32_t native_listed_tile(const struct native_frame *frame, uint32_t listed, uint32_t *pixel)
{
    uint32_t x = frame->tile.x + native_listed_x(listed);
    uint32_t y = frame->tile.y + native_listed_y(listed);
    *pixel = y % TILE_HEIGHT * TILE_WIDTH + x % TILE_WIDTH;
    return (y / TILE_HEIGHT - frame->first_y) * frame->tiles_x + x / TILE_WIDTH - frame->first_x;
}

static void begin_pixels(const struct native_frame *frame, struct native_ray_room *room,
                         const struct native_rounded *rounded, uint32_t first, uint32_t n)
{
    int side = rounded->side;
    room->n_pixels = n;
    room->rays_per_px = (uint32_t)(side * side);
    room->n_rays = room->n_pixels * room->rays_per_px;
    memset(room->listed, 0, sizeof room->listed);
    memset(room->squares, 0, sizeof room->squares);
    for (uint32_t i = 0, ray = 0; i < n; i++) {
        uint32_t listed = rounded->pixel[first + i], pixel;
        uint32_t tile = native_listed_tile(frame, listed, &pixel);
        room->tile = tile;
        room->listed[pixel / TILE_WIDTH][pixel % TILE_WIDTH / 64] |= (uint64_t)1 << pixel % 64;
        room->squares[pixel / TILE_WIDTH / RAY_SQUARE] |= 1u << pixel % TILE_WIDTH / RAY_SQUARE;
        room->first_ray[pixel] = (uint16_t)ray;
        bool is_spread = side * side == NATIVE_MAX_RAYS && native_listed_at_edge(listed);
        for (int k = 0; k < side * side; k++, ray++) {
            room->x[ray] = (float)(frame->tile.x + native_listed_x(listed));
            room->y[ray] = (float)(frame->tile.y + native_listed_y(listed));
            room->off_x[ray] =
                is_spread ? EDGE_RAYS[k][0] : ((float)(k % side) + 0.5f) / (float)side - 0.5f;
            room->off_y[ray] =
                is_spread ? EDGE_RAYS[k][1] : ((float)(k / side) + 0.5f) / (float)side - 0.5f;
            room->z[ray] = RAYS_FARTHEST;
        }
    }
}

bool native_meet_pixels(const struct native_frame *frame, struct native_thread *thread,
                        const struct native_rounded *rounded, uint32_t first, uint32_t n)
{
    struct native_ray_room *room = thread->rays;
    denormals saved = denormals_flush();
    begin_pixels(frame, room, rounded, first, n);
    float(*hit)[HIT_WORDS] = rounded->hit + (size_t)first * room->rays_per_px;
    bool ok = frame->set->see_rays(frame, thread->tile, room);
    room->n_tasks = 0;
    if (ok) {
        ask_on(frame, thread);
        ask_bulges(frame, thread);
        ask_again(frame, thread, rounded->side);
    }
    memset(hit, 0, room->n_rays * sizeof *hit);
    for (uint32_t i = 0; i < room->n_rays; i++)
        if (room->z[i] < RAYS_FARTHEST)
            add_task(room, &(struct native_ray_task){.at = room->met[i]}, i);
    frame->set->describe_rays(frame, thread->tile, room, hit);
    denormals_restore(saved);
    return ok;
}
