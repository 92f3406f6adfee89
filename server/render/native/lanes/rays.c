/* Newton's method for rays of pixels that start on the same sub-patch (rays/rays.h; shaders/walk.glsl,
 * newton.glsl). */
#include "server/render/native/lanes/entries.h"
#include "server/render/native/lanes/stages.h"

#include <math.h>
#include <string.h>

/* Number of sub-patches tried on the way, and how many sub-patches far the tangent plane of one may lead. */
enum { PATCHES = 4, MOST_STEPS = 5 };
static const float MOST_SUB_PATCHES = 16;
/* A ray still this far off inside a sub-patch will not meet it there. */
static const float STUCK_PX = 0.5f;
/* A place of the picture farther away than this is not tried, px. */
static const double MOST_PX = 65536;

/* A sub-patch as seen from the ray through the middle of pixel x, y. */
struct seen_patch {
    struct one_place place;
    float x, y, start;
};

/* The pixel is the one in which the node's origin is seen, so it does not depend on the rays. */
static void see_patch(const struct native_frame *frame, const struct native_seen_node *seen,
                      const struct native_patch *patch, struct seen_patch *on)
{
    const struct view *view = frame->view;
    struct one_place *place = &on->place;
    double slope = view->perspective ? view->units_per_px : 0;
    double start = view->perspective ? 0 : view->units_per_px;
    double inverse = (double)patch->inverse_scale, unit = start + slope * seen->at[2], q[2];
    for (int k = 0; k < 2; k++) {
        double px = unit > 0 ? seen->at[k] / unit : 0;
        px = fmin(fmax(px, -MOST_PX), MOST_PX) + view->centre_px[k];
        q[k] = floor(px) + 0.5 - view->centre_px[k];
        *(k ? &on->y : &on->x) = (float)floor(px);
    }
    place->c = patch->c;
    for (int k = 0; k < 3; k++) {
        double along = (double)seen->camera[2][k];
        place->h[k] = (float)((double)seen->camera[0][k] - q[0] * slope * along);
        place->k[k] = (float)((double)seen->camera[1][k] - q[1] * slope * along);
        place->l[k] = seen->camera[2][k];
    }
    place->a = (float)((seen->at[0] - q[0] * unit) * inverse);
    place->b = (float)((seen->at[1] - q[1] * unit) * inverse);
    place->z = (float)(seen->at[2] * inverse);
    place->before = (float)(seen->before * inverse);
    place->scale = patch->scale;
    place->inverse_scale = patch->inverse_scale;
    place->bend = patch->bend;
    place->is_turned = seen->is_turned;
    place->lost = seen->is_turned ? 1e-13f : 1e-8f;
    memcpy(place->axes, seen->axes, sizeof seen->axes);
    place->any_border = false;
    place->up_x = place->up_y = 1;
    place->x0 = place->y0 = 0;
    on->start = (float)(start * inverse);
}

/* The rays of some lanes as two planes in the node's frame. */
struct lane_rays {
    vfloat h[3], k[3], a, b;
};

LANE_INLINE struct lane_rays rays_of(const struct native_frame *frame,
                                     const struct native_ray_room *room,
                                     const struct seen_patch *on, vint ray)
{
    vfloat x = (v_gather(room->x, ray) - on->x) + v_gather(room->off_x, ray);
    vfloat y = (v_gather(room->y, ray) - on->y) + v_gather(room->off_y, ray);
    vfloat slope_x = x * frame->rays.slope_px, slope_y = y * frame->rays.slope_px;
    struct lane_rays rays;
    for (int k = 0; k < 3; k++) {
        rays.h[k] = on->place.h[k] - slope_x * on->place.l[k];
        rays.k[k] = on->place.k[k] - slope_y * on->place.l[k];
    }
    rays.a = on->place.a - slope_x * on->place.z - x * on->start;
    rays.b = on->place.b - slope_y * on->place.z - y * on->start;
    return rays;
}

/* Distance of the rays from the surface at s, t, in units of the scale, and the depth of the surface there. */
struct distance {
    struct flat_value x, y, z;
};

LANE_INLINE struct distance distance_at(const struct seen_patch *on, const struct lane_rays *rays,
                                        vfloat s, vfloat t)
{
    const struct one_place *place = &on->place;
    struct flat_value p[3];
    struct distance at;
    for (int k = 0; k < 3; k++)
        p[k] = one_flat(place->c[k], s, t);
    at.x.f = rays->h[0] * p[0].f + rays->h[1] * p[1].f + rays->h[2] * p[2].f + rays->a;
    at.x.s = rays->h[0] * p[0].s + rays->h[1] * p[1].s + rays->h[2] * p[2].s;
    at.x.t = rays->h[0] * p[0].t + rays->h[1] * p[1].t + rays->h[2] * p[2].t;
    at.y.f = rays->k[0] * p[0].f + rays->k[1] * p[1].f + rays->k[2] * p[2].f + rays->b;
    at.y.s = rays->k[0] * p[0].s + rays->k[1] * p[1].s + rays->k[2] * p[2].s;
    at.y.t = rays->k[0] * p[0].t + rays->k[1] * p[1].t + rays->k[2] * p[2].t;
    at.z.f = place->l[0] * p[0].f + place->l[1] * p[1].f + place->l[2] * p[2].f + place->z;
    at.z.s = place->l[0] * p[0].s + place->l[1] * p[1].s + place->l[2] * p[2].s;
    at.z.t = place->l[0] * p[0].t + place->l[1] * p[1].t + place->l[2] * p[2].t;
    return at;
}

LANE_INLINE vfloat off_of(const struct distance *at)
{
    return v_sqrt(at->x.f * at->x.f + at->y.f * at->y.f);
}

/* One step of Newton's method, limited to `most` sub-patches; 0 where the ray touches the surface. */
LANE_INLINE vmask step_of(const struct distance *at, float most, vfloat *ds, vfloat *dt)
{
    const struct flat_value *x = &at->x, *y = &at->y;
    vfloat det = x->s * y->t - y->s * x->t;
    vmask touches =
        v_not(v_less(1e-7f * (x->s * x->s + y->s * y->s + x->t * x->t + y->t * y->t), v_abs(det)));
    vfloat inverse = 1 / v_select(touches, v_float(1), det);
    *ds = (y->f * x->t - x->f * y->t) * inverse;
    *dt = (x->f * y->s - y->f * x->s) * inverse;
    vfloat longest = v_max(v_max(v_abs(*ds), v_abs(*dt)), v_float(1e-30f));
    vfloat cut = v_select(touches, v_float(0), v_min(v_float(1), most / longest));
    *ds *= cut;
    *dt *= cut;
    return touches;
}

LANE_INLINE vmask is_within(vfloat s, vfloat t, float low, float high)
{
    return v_at_most(v_float(low), v_min(s, t)) & v_at_most(v_max(s, t), v_float(high));
}

/* The result of Newton's method inside a sub-patch. */
struct outcome {
    vfloat s, t, z;  /* z: world units */
    vmask met, ends; /* met: on the ray; ends: no other sub-patch need be tried */
};

/* solve_patch() of newton.glsl. A step is the last one if its square times the patch's bend is close enough. */
LANE_INLINE struct outcome solve(const struct native_frame *frame, const struct seen_patch *on,
                                 const struct lane_rays *rays, vfloat px, vfloat s, vfloat t,
                                 unsigned lanes)
{
    const struct one_place *place = &on->place;
    vfloat px_per_scale = place->scale / px, enough = v_close_enough(px_per_scale);
    vfloat residual = v_float(1e30f), left = residual, z = v_float(0);
    vmask active = v_mask(lanes), there = v_mask(0);
    for (int i = 0; i < MOST_STEPS && v_bits(active); i++) {
        struct distance at = distance_at(on, rays, s, t);
        vfloat ds, dt, off = off_of(&at) * px_per_scale;
        /* Farther than half a sub-patch the linear model tells little. */
        vmask touches = step_of(&at, 0.5f, &ds, &dt);
        vmask close = v_less(off, enough), leaves = v_not(is_within(s + ds, t + dt, 0, 1));
        vmask stays = close & leaves, moves = active & v_not(stays);
        vfloat longest = v_max(v_abs(ds), v_abs(dt)), most_left = place->bend * longest * longest;
        vmask is_last = close | (v_not(touches) & v_less(most_left * px_per_scale, enough));
        residual = v_select(active, off, residual);
        left = v_select(active, v_select(stays, off / px_per_scale, most_left), left);
        z = v_select(active, at.z.f + v_select(stays, v_float(0), at.z.s * ds + at.z.t * dt), z);
        there = there | (active & is_last);
        s = v_select(moves, s + ds, s);
        t = v_select(moves, t + dt, t);
        active = active & v_not(is_last) & is_within(s, t, -0.5f, 1.5f);
    }
    z *= place->scale;
    vmask inside = is_within(s, t, 0, 1);
    /* Its distance in pixels at the depth where it was met. */
    vfloat own_scale = place->scale / (z * frame->rays.slope_px + frame->rays.start_px);
    vmask near = v_less(left * own_scale, 4 * v_close_enough(own_scale)) & v_less(v_float(0), z);
    vmask stuck = v_not(there) & v_less(v_float(STUCK_PX), residual);
    return (struct outcome){s, t, z, there & inside & near, inside & (there | stuck)};
}

/* Keeps a hit if it is in front of what its ray has met before. */
static void keep(struct native_ray_room *room, uint32_t ray, float z,
                 const struct native_ray_place *at)
{
    if (!(z < room->z[ray]))
        return;
    room->z[ray] = z;
    room->met[ray] = *at;
}

/* The tangent plane at a sub-patch's border leads on, across many sub-patches where they are small. */
static void go_on(const struct native_frame *frame, struct native_ray_room *room,
                  const struct native_ray_group *group, const struct seen_patch *on,
                  const struct lane_rays *rays, const struct outcome *out, uint32_t first,
                  unsigned lanes)
{
    const struct limit_node *node = &frame->model->tables->nodes[group->node];
    const struct native_part_of_node part = native_part_of_index(node, group->index);
    vfloat s = v_clamp(out->s, 0, 1), t = v_clamp(out->t, 0, 1), ds, dt;
    struct distance at = distance_at(on, rays, s, t);
    step_of(&at, MOST_SUB_PATCHES, &ds, &dt);
    s += ds;
    t += dt;
    double to_x = native_power(-part.scale_x), to_y = native_power(-part.scale_y);
    for (unsigned left = lanes; left; left &= left - 1) {
        int k = __builtin_ctz(left);
        double x = (part.origin_x + (double)s[k]) * to_x, y = (part.origin_y + (double)t[k]) * to_y;
        struct native_ray_task *task = &room->task[room->n_tasks];
        task->at.node = group->node;
        if (!native_walk(frame->model->tables, &task->at.node, &x, &y))
            continue;
        native_ray_begin(&frame->model->tables->nodes[task->at.node], x, y, &task->at);
        task->patch = NULL;
        task->px = room->px[first + (uint32_t)k];
        task->ray = (uint32_t)room->ray[first + (uint32_t)k];
        room->n_tasks++;
    }
}

static const struct native_patch *patch_of(const struct native_frame *frame,
                                           struct native_tile_room *tile,
                                           const struct native_ray_group *group)
{
    return group->patch ? group->patch : native_patch_of(frame, tile, group->node, group->index);
}

static void meet_group(const struct native_frame *frame, struct native_tile_room *tile,
                       struct native_ray_room *room, const struct native_ray_group *group,
                       const struct native_seen_node *seen, bool is_last)
{
    struct seen_patch on;
    see_patch(frame, seen, patch_of(frame, tile, group), &on);
    for (uint32_t i = group->first, end = group->first + group->n; i < end; i += LANES) {
        unsigned lanes = v_first(end - i);
        const struct lane_rays rays = rays_of(frame, room, &on, v_load_int(room->ray + i));
        struct outcome out = solve(frame, &on, &rays, v_load(room->px + i), v_load(room->s + i),
                                   v_load(room->t + i), lanes);
        for (unsigned left = v_bits(out.met) & lanes; left; left &= left - 1) {
            int k = __builtin_ctz(left);
            const struct native_ray_place at = {group->node, group->index, out.s[k], out.t[k]};
            keep(room, (uint32_t)room->ray[i + (uint32_t)k], out.z[k], &at);
        }
        unsigned onwards = is_last ? 0 : lanes & ~v_bits(out.ends);
        if (onwards)
            go_on(frame, room, group, &on, &rays, &out, i, onwards);
    }
}

/* Inside the last ring of an extraordinary vertex the surface is its tangent plane, or a plane perpendicular to the
 * view if it has none (meet_limit() of walk.glsl). */
static void meet_at_vertex(const struct native_frame *frame, struct native_tile_room *tile,
                           struct native_ray_room *room, const struct native_ray_group *group,
                           const struct native_seen_node *seen)
{
    const struct view *view = frame->view;
    const struct limit_node *node = &frame->model->tables->nodes[group->node];
    uint32_t last = native_patch_index(node, (int)limit_levels(node), 1);
    double scale = (double)native_patch_of(frame, tile, group->node, last)->scale;
    bool has_normal = !(node->levels & LIMIT_NO_NORMAL);
    double n[3], slope = view->perspective ? view->units_per_px : 0;
    double start = view->perspective ? 0 : view->units_per_px;
    for (int k = 0; k < 3; k++)
        n[k] = has_normal ? (double)seen->camera[k][2] : k == 2;
    for (uint32_t i = group->first; i < group->first + group->n; i++) {
        uint32_t ray = (uint32_t)room->ray[i];
        double x = (double)room->x[ray] + 0.5 + (double)room->off_x[ray] - view->centre_px[0];
        double y = (double)room->y[ray] + 0.5 + (double)room->off_y[ray] - view->centre_px[1];
        const double *o = seen->at;
        double z = (n[0] * (o[0] - x * start) + n[1] * (o[1] - y * start) + n[2] * o[2]) /
                   (n[0] * x * slope + n[1] * y * slope + n[2]);
        double off_x = x * (start + slope * z) - o[0], off_y = y * (start + slope * z) - o[1];
        double off2 = off_x * off_x + off_y * off_y + (z - o[2]) * (z - o[2]);
        if (z > 0 && off2 < 4 * scale * scale)
            keep(room, ray, (float)z,
                 &(struct native_ray_place){.node = group->node, .index = group->index});
    }
}

/* Meets the rays of all groups. Those that go on become tasks, unless it is the last time. */
static void meet_groups(const struct native_frame *frame, struct native_tile_room *tile,
                        struct native_ray_room *room, bool is_last)
{
    struct native_seen_node seen;
    for (uint32_t k = 0; k < room->n_groups; k++) {
        const struct native_ray_group *group = &room->group[k];
        native_see_node(frame, &frame->model->tables->nodes[group->node], &seen);
        if (group->index & RAY_AT_VERTEX)
            meet_at_vertex(frame, tile, room, group, &seen);
        else
            meet_group(frame, tile, room, group, &seen, is_last);
    }
    room->n_groups = 0;
}

void LANE_NAME(native_meet_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                                 struct native_ray_room *room)
{
    meet_groups(frame, tile, room, false);
    for (int i = 0; i < PATCHES && room->n_tasks; i++) {
        native_group_rays(frame->model, room);
        room->n_tasks = 0;
        meet_groups(frame, tile, room, i == PATCHES - 1);
    }
    room->n_tasks = 0;
}

/* --- */

/* Describes the vertex itself, where the surface does not bend. */
static void describe_vertex(const struct native_frame *frame, const struct native_ray_room *room,
                            const struct native_ray_group *group,
                            const struct native_seen_node *seen, float (*hit)[HIT_WORDS])
{
    const struct limit_node *node = &frame->model->tables->nodes[group->node];
    for (uint32_t i = group->first; i < group->first + group->n; i++) {
        float *to = hit[room->ray[i]];
        for (int k = 0; k < 3; k++)
            to[k] = node->levels & LIMIT_NO_NORMAL ? 0 : seen->axes[k][2];
        to[3] = room->z[room->ray[i]];
    }
}

static void describe_group(const struct native_frame *frame, struct native_tile_room *tile,
                           const struct native_ray_room *room, const struct native_ray_group *group,
                           const struct native_seen_node *seen, float (*hit)[HIT_WORDS])
{
    struct seen_patch on;
    see_patch(frame, seen, patch_of(frame, tile, group), &on);
    for (uint32_t i = group->first, end = group->first + group->n; i < end; i += LANES) {
        struct derivatives at;
        struct described found;
        vfloat s = v_load(room->s + i), t = v_load(room->t + i);
        const vfloat no_planes[3] = {s, s, s}; /* only borders need them */
        one_all(&on.place, s, t, &at);
        one_describe(&on.place, &frame->rays, no_planes, no_planes, &at, s, t, &found);
        for (int k = 0; k < LANES && i + (uint32_t)k < end; k++) {
            float *to = hit[room->ray[i + (uint32_t)k]];
            for (int j = 0; j < 3; j++) {
                to[j] = found.n[j][k];
                to[4 + j] = found.shape[j][k];
            }
            to[3] = found.z[k];
        }
    }
}

void LANE_NAME(native_describe_rays)(const struct native_frame *frame,
                                     struct native_tile_room *tile, struct native_ray_room *room,
                                     float (*hit)[HIT_WORDS])
{
    native_group_rays(frame->model, room);
    for (uint32_t k = 0; k < room->n_groups; k++) {
        const struct native_ray_group *group = &room->group[k];
        struct native_seen_node seen;
        native_see_node(frame, &frame->model->tables->nodes[group->node], &seen);
        if (group->index & RAY_AT_VERTEX)
            describe_vertex(frame, room, group, &seen, hit);
        else
            describe_group(frame, tile, room, group, &seen, hit);
    }
}
