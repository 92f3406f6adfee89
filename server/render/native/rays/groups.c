/* Sorts rays by the sub-patch that they start on. */
#include "server/render/native/rays/rays.h"

#include <assert.h>
#include <string.h>

static_assert(RAYS_AT_ONCE < UINT16_MAX, "groups are numbered by 16 bits");

void native_forget_ray_patches(struct native_ray_room *room)
{
    memset(room->patch, 0, sizeof room->patch);
    room->n_patches = room->sorting = 0;
}

/* The index at which the search for a sub-patch begins. */
static uint32_t hash(const struct native_ray_place *at)
{
    uint64_t mixed = ((uint64_t)at->node << 16 | at->index) * 0x9e3779b97f4a7c15u;
    return (uint32_t)(mixed >> 40) & (RAY_PATCHES - 1);
}

static struct native_ray_patch *patch_at(const struct native_model *model,
                                         struct native_ray_room *room,
                                         const struct native_ray_place *at,
                                         const struct native_patch *patch)
{
    for (uint32_t k = hash(at);; k = (k + 1) & (RAY_PATCHES - 1)) {
        struct native_ray_patch *found = &room->patch[k];
        if (!found->sorting) {
            *found = (struct native_ray_patch){.node = at->node, .index = at->index};
            room->n_patches++;
        }
        if (found->node != at->node || found->index != at->index)
            continue;
        if (!found->patch && !(at->index & RAY_AT_VERTEX))
            found->patch = patch ? patch : native_patch_find(model, at->node, at->index);
        return found;
    }
}

/* A patch is read only some time after its number is known. */
static void prefetch(const struct native_patch *patch)
{
    for (int line = 0; patch && line < 4; line++)
        __builtin_prefetch((const char *)patch + 64 * line);
}

static uint32_t group_of(const struct native_model *model, struct native_ray_room *room,
                         const struct native_ray_task *task)
{
    const struct native_ray_place *at = &task->at;
    struct native_ray_patch *found = patch_at(model, room, at, task->patch);
    if (found->sorting != room->sorting) {
        found->sorting = room->sorting;
        found->group = (uint16_t)room->n_groups;
        prefetch(found->patch);
        room->group[room->n_groups++] =
            (struct native_ray_group){.node = at->node, .index = at->index, .patch = found->patch};
    }
    return found->group;
}

void native_group_rays(const struct native_model *model, struct native_ray_room *room)
{
    uint32_t last = 0, first = 0;
    if (room->n_patches + room->n_tasks > RAY_PATCHES / 2)
        native_forget_ray_patches(room);
    room->sorting++;
    room->n_groups = 0;
    for (uint32_t i = 0; i < room->n_tasks; i++) {
        const struct native_ray_place *at = &room->task[i].at;
        /* Consecutive tasks are often on the same sub-patch. */
        if (i == 0 || room->group[last].node != at->node || room->group[last].index != at->index)
            last = group_of(model, room, &room->task[i]);
        room->group_of[i] = (uint16_t)last;
        room->group[last].n++;
    }
    for (uint32_t k = 0; k < room->n_groups; k++) {
        room->group[k].first = first;
        first += room->group[k].n;
        room->group[k].n = 0;
    }
    for (uint32_t i = 0; i < room->n_tasks; i++) {
        const struct native_ray_task *task = &room->task[i];
        struct native_ray_group *group = &room->group[room->group_of[i]];
        uint32_t to = group->first + group->n++;
        room->s[to] = task->at.s;
        room->t[to] = task->at.t;
        room->px[to] = task->px;
        room->ray[to] = (int32_t)task->ray;
    }
    /* The last vector reads beyond the last ray. */
    memset(room->ray + room->n_tasks, 0, RAYS_END * sizeof *room->ray);
}

void native_ray_start(const struct native_frame *frame, const struct native_tile_room *tile,
                      struct native_ray_room *room, const struct native_ray_pieces *pieces,
                      uint32_t ray)
{
    struct native_task at = {0};
    struct native_ray_task *task = &room->task[room->n_tasks++];
    float depth = native_ray_depth(&frame->rays, pieces->nearness[ray]);
    native_begin_on(frame->model, &at, tile->local[pieces->piece[ray]], pieces->place[ray]);
    *task = (struct native_ray_task){
        .at = {at.node, at.part.at_vertex ? RAY_AT_VERTEX : (uint16_t)at.part.index, at.s, at.t},
        .px = native_pixel_units(&frame->rays, depth),
        .ray = ray,
        .patch = at.patch};
}

/* Begins the group of each piece that n[k] rays start on. n[k] becomes the first of them, or NOT_SORTED. */
enum { NOT_SORTED = UINT32_MAX };
static uint32_t begin_groups(const struct native_frame *frame, const struct native_tile_room *tile,
                             struct native_ray_room *room, uint32_t *n)
{
    uint32_t first = 0;
    room->n_groups = 0;
    for (size_t k = 0; k < tile->n_local; k++) {
        const struct native_piece *piece = tile->local[k];
        if (n[k] == 0)
            continue;
        if (piece->kind != PIECE_OF_PATCH) {
            n[k] = NOT_SORTED;
            continue;
        }
        struct native_ray_group *group = &room->group[room->n_groups++];
        *group = (struct native_ray_group){
            .node = piece->node, .first = first, .n = n[k], .patch = native_piece_patch(piece)};
        group->index =
            (uint16_t)native_piece_index(&frame->model->tables->nodes[piece->node], piece);
        n[k] = first;
        first += group->n;
    }
    return first;
}

void native_group_pieces(const struct native_frame *frame, struct native_tile_room *tile,
                         struct native_ray_room *room)
{
    const struct native_ray_pieces *on = &room->on;
    uint32_t *next = tile->count, n;
    memset(next, 0, tile->n_local * sizeof *next);
    for (uint32_t ray = 0; ray < room->n_rays; ray++)
        if (on->nearness[ray] > 0)
            next[on->piece[ray]]++;
    n = begin_groups(frame, tile, room, next);
    for (uint32_t ray = 0; ray < room->n_rays; ray++) {
        if (!(on->nearness[ray] > 0))
            continue;
        uint32_t *to = &next[on->piece[ray]], place = (uint32_t)on->place[ray];
        if (*to == NOT_SORTED) {
            native_ray_start(frame, tile, room, on, ray);
            continue;
        }
        const struct native_piece *piece = tile->local[on->piece[ray]];
        const float step = piece->size * (1 / 65535.0f);
        room->s[*to] = piece->s + (float)(place & 0xffff) * step;
        room->t[*to] = piece->t + (float)(place >> 16) * step;
        room->px[*to] =
            native_pixel_units(&frame->rays, native_ray_depth(&frame->rays, on->nearness[ray]));
        room->ray[(*to)++] = (int32_t)ray;
    }
    memset(room->ray + n, 0, RAYS_END * sizeof *room->ray);
}

void native_ray_begin(const struct limit_node *node, double x, double y,
                      struct native_ray_place *place)
{
    const struct native_part_of_node part = native_patch_at(node, x, y);
    place->index = part.at_vertex ? RAY_AT_VERTEX : (uint16_t)part.index;
    place->s = (float)(x * native_power(part.scale_x) - part.origin_x);
    place->t = (float)(y * native_power(part.scale_y) - part.origin_y);
}

struct native_part_of_node native_part_of_index(const struct limit_node *node, uint32_t index)
{
    struct native_part_of_node part = {.index = index};
    if (node->kind == LIMIT_CORNER) {
        unsigned square = index % 3 + 1;
        part.scale_x = part.scale_y = (int8_t)(index / 3 + 1);
        part.origin_x = square < 3;
        part.origin_y = square > 1;
    } else if (node->kind == LIMIT_STRIP) {
        bool is_last = index == limit_levels(node); /* as wide as the patch before it */
        part.scale_y = (int8_t)(index + !is_last);
        part.origin_y = !is_last;
    }
    return part;
}
