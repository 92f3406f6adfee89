/* Chooses where rays of pixels start: shaders/rounded_solve.comp.glsl gives the order of guesses. */
#include "server/render/native/rays/rays.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "server/render/native/denormals.h"

/* Newton's method starts at one place for all rays of a pixel, or for those on one side of it. */
enum { GUESSES = 4, BESIDE_ROUNDS = 2, BESIDE = 4 };
/* seen.glsl: a slope of this many px of depth per px. */
static const float DOUBT_PX = 4;

static const float EDGE_RAYS[][2] = {
#include "edge_rays.inc" /* of shaders/rounded.glsl */
};
static_assert(sizeof EDGE_RAYS / sizeof *EDGE_RAYS == NATIVE_MAX_RAYS, "a place for each ray");

/* Finds the place where a pixel of the tile meets the surface. False if it meets none. */
static bool guess_of(const struct native_frame *frame, uint32_t x, uint32_t y,
                     struct native_ray_task *task)
{
    const struct native_planes *planes = frame->planes;
    size_t at = y * planes->pitch + x;
    if (!(planes->depth[at] > 0))
        return false;
    uint32_t where = planes->where[at];
    const struct limit_node *node = &frame->model->tables->nodes[planes->node[at]];
    double down = native_power(-(int)(where & 63));
    double across = node->kind == LIMIT_STRIP ? 1 : down;
    double s = fmin((where >> 6 & 8191) * (2 / 8191.0) * across, 1);
    double t = fmin((where >> 19) * (2 / 8191.0) * down, 1);
    task->at.node = planes->node[at];
    native_ray_begin(node, s, t, &task->at);
    task->px = native_pixel_units(&frame->rays, planes->depth[at]);
    return true;
}

static bool is_in_front(const struct native_frame *frame, float there, float z)
{
    return there < z - DOUBT_PX * native_pixel_units(&frame->rays, z);
}

static uint32_t beside(uint32_t at, int by, uint32_t n)
{
    return by < 0 ? at - (at > 0) : at + (by > 0 && at + 1 < n);
}

static float nearest_beside(const struct native_frame *frame, uint32_t x, uint32_t y)
{
    static const int steps[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    float nearest = RAYS_FARTHEST;
    for (int k = 0; k < 4; k++) {
        size_t at = beside(y, steps[k][1], frame->tile.height) * frame->planes->pitch +
                    beside(x, steps[k][0], frame->tile.width);
        float z = frame->planes->depth[at];
        nearest = z > 0 && z < nearest ? z : nearest;
    }
    return nearest;
}

static int sign(float a)
{
    return (a > 0) - (a < 0);
}

static void add_task(struct native_ray_room *room, const struct native_ray_task *begin,
                     uint32_t ray)
{
    struct native_ray_task *task = &room->task[room->n_tasks++];
    *task = *begin;
    task->ray = ray;
}

/* A ray that has a hit goes on only because something lies in front of it, so guesses that are no nearer are
 * skipped. */
static bool is_passed_by(const struct native_frame *frame, float z, uint32_t x, uint32_t y)
{
    float there = frame->planes->depth[y * frame->planes->pitch + x];
    return z < RAYS_FARTHEST && !(there < z);
}

/* Guess k of each ray: its own pixel's, then those of the pixels on the side to which it lies: beside, above or
 * below, and diagonal. */
static void ask_centres(const struct native_frame *frame, struct native_ray_room *room, int k)
{
    for (uint32_t i = 0; i < room->n_pixels; i++) {
        const struct native_ray_pixel *pixel = &room->pixel[i];
        struct native_ray_task begin[3][3];
        bool is_asked[3][3] = {0}, is_there[3][3];
        for (unsigned left = pixel->asks; left; left &= left - 1) {
            uint32_t ray = i * room->rays_per_px + (uint32_t)__builtin_ctz(left);
            int dx = k & 1 ? sign(room->off_x[ray]) : 0, dy = k & 2 ? sign(room->off_y[ray]) : 0;
            struct native_ray_task *from = &begin[dy + 1][dx + 1];
            uint32_t x = beside(pixel->x, dx, frame->tile.width);
            uint32_t y = beside(pixel->y, dy, frame->tile.height);
            if (k && x == pixel->x && y == pixel->y)
                continue; /* already tried */
            if (is_passed_by(frame, room->z[ray], x, y))
                continue;
            if (!is_asked[dy + 1][dx + 1])
                is_there[dy + 1][dx + 1] = guess_of(frame, x, y, from);
            is_asked[dy + 1][dx + 1] = true;
            if (is_there[dy + 1][dx + 1])
                add_task(room, from, ray);
        }
    }
}

/* Rays that have a hit stop, unless something lies in front of it. */
static void see_who_asks(const struct native_frame *frame, struct native_ray_room *room)
{
    for (uint32_t i = 0; i < room->n_pixels; i++) {
        struct native_ray_pixel *pixel = &room->pixel[i];
        for (unsigned left = pixel->asks; left; left &= left - 1) {
            int k = __builtin_ctz(left);
            float z = room->z[i * room->rays_per_px + (uint32_t)k];
            if (z < RAYS_FARTHEST && !is_in_front(frame, pixel->front, z))
                pixel->asks &= ~(1u << k);
        }
    }
}

/* The rays that have met nothing. */
static unsigned unmet_of(const struct native_ray_room *room, uint32_t pixel)
{
    const float *z = room->z + pixel * room->rays_per_px;
    unsigned unmet = 0;
    for (uint32_t k = 0; k < room->rays_per_px; k++)
        unmet |= z[k] < RAYS_FARTHEST ? 0 : 1u << k;
    return unmet;
}

/* Rays without a hit start from the k-th ray beside them that had a hit when pixel->asks was set. */
static void ask_beside(const struct native_frame *frame, struct native_ray_room *room, int side,
                       int k)
{
    static const int steps[BESIDE][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (uint32_t i = 0; i < room->n_pixels; i++) {
        unsigned unmet = room->pixel[i].asks;
        for (unsigned left = unmet & unmet_of(room, i); left; left &= left - 1) {
            int part = __builtin_ctz(left);
            int x = part % side + steps[k][0], y = part / side + steps[k][1];
            if (x < 0 || y < 0 || x >= side || y >= side || unmet >> (y * side + x) & 1)
                continue;
            uint32_t first = i * room->rays_per_px, from = first + (uint32_t)(y * side + x);
            const struct native_ray_task begin = {
                .at = room->met[from], .px = native_pixel_units(&frame->rays, room->z[from])};
            add_task(room, &begin, first + (uint32_t)part);
        }
    }
}

/* --- pixels */

static void begin_pixels(const struct native_frame *frame, struct native_ray_room *room,
                         const struct native_rounded *rounded, uint32_t first, uint32_t n)
{
    enum { AT_EDGE = 0x8000 }; /* added to y: rounded.glsl */
    int side = rounded->side;
    room->n_pixels = n;
    room->rays_per_px = (uint32_t)(side * side);
    room->n_rays = room->n_pixels * room->rays_per_px;
    for (uint32_t i = 0, ray = 0; i < room->n_pixels; i++) {
        struct native_ray_pixel *pixel = &room->pixel[i];
        uint32_t listed = rounded->pixel[first + i];
        bool at_edge = listed >> 16 & AT_EDGE;
        pixel->x = listed & 0xffff;
        pixel->y = listed >> 16 & (AT_EDGE - 1);
        pixel->front = nearest_beside(frame, pixel->x, pixel->y);
        pixel->asks = (1u << room->rays_per_px) - 1;
        for (int k = 0; k < side * side; k++, ray++) {
            bool is_spread = side == 4 && at_edge;
            room->x[ray] = (float)(frame->tile.x + pixel->x);
            room->y[ray] = (float)(frame->tile.y + pixel->y);
            room->off_x[ray] =
                is_spread ? EDGE_RAYS[k][0] : ((float)(k % side) + 0.5f) / (float)side - 0.5f;
            room->off_y[ray] =
                is_spread ? EDGE_RAYS[k][1] : ((float)(k / side) + 0.5f) / (float)side - 0.5f;
            room->z[ray] = RAYS_FARTHEST;
        }
    }
}

static void meet_tasks(const struct native_frame *frame, struct native_thread *thread)
{
    frame->set->meet_rays(frame, thread->tile, thread->rays);
    thread->rays->n_tasks = 0;
}

static void meet_rays(const struct native_frame *frame, struct native_thread *thread, int side)
{
    struct native_ray_room *room = thread->rays;
    room->n_tasks = 0;
    for (int k = 0; k < GUESSES; k++) {
        ask_centres(frame, room, k);
        meet_tasks(frame, thread);
        see_who_asks(frame, room);
    }
    for (int i = 0; i < BESIDE_ROUNDS; i++) {
        for (uint32_t p = 0; p < room->n_pixels; p++)
            room->pixel[p].asks = unmet_of(room, p);
        for (int k = 0; k < BESIDE; k++) {
            ask_beside(frame, room, side, k);
            meet_tasks(frame, thread);
        }
    }
}

void native_meet_pixels(const struct native_frame *frame, struct native_thread *thread,
                        const struct native_rounded *rounded, uint32_t first, uint32_t n)
{
    struct native_ray_room *room = thread->rays;
    denormals saved = denormals_flush();
    begin_pixels(frame, room, rounded, first, n);
    float(*hit)[HIT_WORDS] = rounded->hit + (size_t)first * room->rays_per_px;
    meet_rays(frame, thread, rounded->side);
    memset(hit, 0, room->n_rays * sizeof *hit);
    for (uint32_t i = 0; i < room->n_rays; i++)
        if (room->z[i] < RAYS_FARTHEST)
            add_task(room, &(struct native_ray_task){.at = room->met[i]}, i);
    frame->set->describe_rays(frame, thread->tile, room, hit);
    denormals_restore(saved);
}
