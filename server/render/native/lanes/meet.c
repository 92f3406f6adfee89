/* Newton's method from a guess across borders of sub-patches, nodes and faces (shaders/walk.glsl, newton.glsl), for
 * rays and patches that differ from lane to lane. */
#include "server/render/native/lanes/stages.h"

#include <math.h>
#include <string.h>

/* Number of sub-patches tried on the way, and how many sub-patches far the tangent plane of one may lead. */
enum { PATCHES = 4, MOST_STEPS = 5 };
static const float MOST_SUB_PATCHES = 16;
/* A ray still this far off inside a sub-patch will not meet it there. */
static const float STUCK_PX = 0.5f;

/* A patch for each lane, and its lanes' coefficients. */
struct lanes {
    struct each_place place;
    vfloat c[3][4][4];
};

static inline void set(vfloat *lanes, int lane, double value)
{
    (*lanes)[lane] = (float)value;
}

static void set_coefficients(struct lanes *lanes, int lane, const struct native_patch *patch)
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 16; i++)
            lanes->c[k][i / 4][i % 4][lane] = patch->c[k][i / 4][i % 4];
    set(&lanes->place.scale, lane, (double)patch->scale);
    set(&lanes->place.inverse_scale, lane, (double)patch->inverse_scale);
    set(&lanes->place.bend, lane, (double)patch->bend);
}

/* At the vertex of a CORNER the surface is its tangent plane, or a plane perpendicular to the view if it has none.
 * `turned`: the view's axes in the node's frame. */
static void set_vertex(const struct native_frame *frame, struct native_tile_room *room,
                       struct lanes *lanes, int lane, uint32_t node_index, const float turned[3][3])
{
    const struct limit_node *node = &frame->model->tables->nodes[node_index];
    bool has_normal = !(node->levels & LIMIT_NO_NORMAL);
    const struct native_patch *last = native_patch_of(
        frame, room, node_index, native_patch_index(node, (int)limit_levels(node), 1));
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 16; i++)
            lanes->c[k][i / 4][i % 4][lane] = 0;
        lanes->c[k][0][1][lane] = has_normal ? k == 0 : turned[0][k];
        lanes->c[k][1][0][lane] = has_normal ? k == 1 : turned[1][k];
    }
    set(&lanes->place.scale, lane, (double)last->scale);
    set(&lanes->place.inverse_scale, lane, (double)last->inverse_scale);
    set(&lanes->place.bend, lane, 0);
}

/* Sets a lane to the sub-patch of a node, seen from the ray through a place of the picture. */
static void set_lane(const struct native_frame *frame, struct native_tile_room *room,
                     struct lanes *lanes, int lane, uint32_t node_index,
                     const struct native_part_of_node *part, const struct native_patch *patch,
                     const double at_px[2], const struct native_seen_node *seen)
{
    const struct view *view = frame->view;
    struct each_place *place = &lanes->place;
    if (part->at_vertex)
        set_vertex(frame, room, lanes, lane, node_index, (const float(*)[3])seen->camera);
    else
        set_coefficients(lanes, lane,
                         patch ? patch : native_patch_of(frame, room, node_index, part->index));
    double inverse = (double)place->inverse_scale[lane];
    double q_x = (at_px[0] - view->centre_px[0]) * view->units_per_px;
    double q_y = (at_px[1] - view->centre_px[1]) * view->units_per_px;
    double slope_x = view->perspective ? q_x : 0, start_x = q_x - slope_x;
    double slope_y = view->perspective ? q_y : 0, start_y = q_y - slope_y;
    for (int k = 0; k < 3; k++) {
        double along = (double)seen->camera[2][k];
        set(&place->h[k], lane, (double)seen->camera[0][k] - slope_x * along);
        set(&place->k[k], lane, (double)seen->camera[1][k] - slope_y * along);
        set(&place->l[k], lane, along);
    }
    set(&place->a, lane, (seen->at[0] - start_x - slope_x * seen->at[2]) * inverse);
    set(&place->b, lane, (seen->at[1] - start_y - slope_y * seen->at[2]) * inverse);
    set(&place->z, lane, seen->at[2] * inverse);
    set(&place->before, lane, seen->before * inverse);
}

/* Sets what is needed to describe the place that was met. */
static void set_met(const struct native_frame *frame, struct native_tile_room *room,
                    struct lanes *lanes, int lane, const struct native_met *met,
                    const double at_px[2])
{
    const struct limit_node *node = &frame->model->tables->nodes[met->node];
    struct each_place *place = &lanes->place;
    struct native_seen_node seen;
    struct native_borders borders;
    double x0 = met->part.origin_x, y0 = met->part.origin_y;
    native_see_node(frame, node, &seen);
    set_lane(frame, room, lanes, lane, met->node, &met->part, NULL, at_px, &seen);
    native_borders_of(node, &borders);
    if (met->part.at_vertex) { /* s and t are those of the tangent plane */
        x0 = met->x * native_power(met->part.scale_x) - (double)met->s;
        y0 = met->y * native_power(met->part.scale_y) - (double)met->t;
    }
    for (int e = 0; e < 4; e++) {
        set(&place->has_border[e], lane, (double)borders.is[e]);
        set(&place->beyond[e], lane, (double)borders.beyond[e]);
        set(&place->rounding[e], lane, (double)borders.rounding[e]);
    }
    for (int i = 0; i < 9; i++)
        set(&place->axes[i / 3][i % 3], lane, (double)seen.axes[i / 3][i % 3]);
    set(&place->lost, lane, seen.is_turned ? 1e-13 : 1e-8);
    set(&place->up_x, lane, native_power(met->part.scale_x));
    set(&place->up_y, lane, native_power(met->part.scale_y));
    set(&place->x0, lane, x0);
    set(&place->y0, lane, y0);
}

/* --- */

/* The points' distances from the ray's two planes, and along the view axis. */
struct flat {
    vfloat x[4][4], y[4][4], z[4][4];
};

static void project(const struct lanes *lanes, struct flat *flat)
{
    const struct each_place *place = &lanes->place;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            vfloat p[3] = {lanes->c[0][j][i], lanes->c[1][j][i], lanes->c[2][j][i]};
            flat->x[j][i] = v_dot(place->h, p);
            flat->y[j][i] = v_dot(place->k, p);
            flat->z[j][i] = v_dot(place->l, p);
        }
    }
    flat->x[0][0] += place->a;
    flat->y[0][0] += place->b;
}

/* One step from (s,t), limited to `most` sub-patches; 0 where the ray touches the surface. Returns the surface's
 * distance from the ray at (s,t). */
LANE_INLINE vfloat newton_step(const struct flat *flat, vfloat s, vfloat t, float most, vfloat *ds,
                               vfloat *dt)
{
    struct flat_value x = each_flat(flat->x, s, t), y = each_flat(flat->y, s, t);
    vfloat det = x.s * y.t - y.s * x.t;
    vmask touches =
        v_not(v_less(1e-7f * (x.s * x.s + y.s * y.s + x.t * x.t + y.t * y.t), v_abs(det)));
    vfloat inverse = 1 / v_select(touches, v_float(1), det);
    *ds = (y.f * x.t - x.f * y.t) * inverse;
    *dt = (x.f * y.s - y.f * x.s) * inverse;
    vfloat longest = v_max(v_max(v_abs(*ds), v_abs(*dt)), v_float(1e-30f));
    vfloat cut = v_select(touches, v_float(0), v_min(v_float(1), most / longest));
    *ds *= cut;
    *dt *= cut;
    return v_sqrt(x.f * x.f + y.f * y.f);
}

LANE_INLINE vmask is_within(vfloat s, vfloat t, float low, float high)
{
    return v_at_most(v_float(low), v_min(s, t)) & v_at_most(v_max(s, t), v_float(high));
}

/* The result of Newton's method inside each lane's sub-patch. */
struct outcome {
    vfloat s, t, on_s, on_t; /* on_s, on_t: where the tangent plane leads from the border */
    vfloat before;
    vmask inside, settled, near;
};

static void solve(const struct native_rays *rays, const struct lanes *lanes, vfloat px, vfloat s,
                  vfloat t, struct outcome *out)
{
    const struct each_place *place = &lanes->place;
    struct flat flat;
    project(lanes, &flat);
    vfloat px_per_scale = place->scale / px, enough = v_close_enough(px_per_scale);
    vfloat residual = v_float(1e30f), ds, dt;
    vmask active = v_less(v_float(0), residual);
    for (int i = 0; i < MOST_STEPS && v_bits(active); i++) {
        /* Farther than half a sub-patch the linear model tells little. */
        vfloat off = newton_step(&flat, s, t, 0.5f, &ds, &dt) * px_per_scale;
        vmask close = v_less(off, enough), leaves = v_not(is_within(s + ds, t + dt, 0, 1));
        vmask moves = active & v_not(close & leaves);
        residual = v_select(active, off, residual);
        s = v_select(moves, s + ds, s);
        t = v_select(moves, t + dt, t);
        active = active & v_not(close) & is_within(s, t, -0.5f, 1.5f);
    }
    out->inside = is_within(s, t, 0, 1);
    out->settled = out->inside & (v_less(residual, enough) | v_less(v_float(STUCK_PX), residual));
    struct flat_value along = each_flat(flat.z, s, t);
    vfloat z = (place->z + along.f) * place->scale, own_px = z * rays->slope_px + rays->start_px;
    vfloat own_scale = place->scale / own_px;
    vfloat off = newton_step(&flat, s, t, 0.5f, &ds, &dt) * own_scale;
    out->near = v_less(off, 4 * v_close_enough(own_scale)) & v_less(v_float(0), z);
    out->s = s;
    out->t = t;
    out->before = (place->before - along.f) * place->scale;
    vfloat border_s = v_clamp(s, 0, 1), border_t = v_clamp(t, 0, 1);
    newton_step(&flat, border_s, border_t, MOST_SUB_PATCHES, &ds, &dt);
    out->on_s = border_s + ds;
    out->on_t = border_t + dt;
}

/* --- */

/* Stores lane k's result in its task. True if the task must go on from another place. */
static bool conclude(const struct native_frame *frame, struct native_task *task,
                     struct native_met *met, const struct outcome *at, int k, bool is_last)
{
    const struct native_part_of_node *part = &task->part;
    double to_x = native_power(-part->scale_x), to_y = native_power(-part->scale_y);
    unsigned lane = 1u << k;
    *met = (struct native_met){
        .node = task->node, .part = *part, .s = at->s[k], .t = at->t[k], .before = at->before[k]};
    bool is_near = v_bits(at->near) & lane;
    if (part->at_vertex) { /* within two of the last level's squares */
        met->x = (part->origin_x + (double)task->s) * to_x;
        met->y = (part->origin_y + (double)task->t) * to_y;
        met->found = is_near && hypotf(at->s[k], at->t[k]) < 2;
        return false;
    }
    if (v_bits(at->settled) & lane || is_last) {
        met->x = (part->origin_x + (double)at->s[k]) * to_x;
        met->y = (part->origin_y + (double)at->t[k]) * to_y;
        met->found = is_near && v_bits(at->inside) & lane;
        return false;
    }
    double x = (part->origin_x + (double)at->on_s[k]) * to_x;
    double y = (part->origin_y + (double)at->on_t[k]) * to_y;
    if (!native_walk(frame->model->tables, &task->node, &x, &y))
        return false;
    native_begin_at(frame->model, task, x, y);
    return true;
}

/* Solves up to LANES tasks. Writes those that must go on to `onwards`; returns their number. */
static uint32_t meet_lanes(const struct native_frame *frame, struct native_tile_room *room,
                           const uint32_t *which, int n, bool is_last, uint32_t *onwards)
{
    const struct native_rays *rays = &frame->rays;
    struct lanes lanes;
    struct outcome outcome;
    float s[LANES], t[LANES], px[LANES];
    struct native_seen_node seen;
    uint32_t seen_node = UINT32_MAX;  /* tasks that follow each other often have one node */
    for (int k = 0; k < LANES; k++) { /* lanes without a task repeat the last one */
        const struct native_task *task = &room->task[which[k < n ? k : n - 1]];
        if (task->node != seen_node)
            native_see_node(frame, &frame->model->tables->nodes[task->node], &seen);
        seen_node = task->node;
        set_lane(frame, room, &lanes, k, task->node, &task->part, task->patch, task->at_px, &seen);
        s[k] = task->s;
        t[k] = task->t;
        px[k] = native_pixel_units(rays, rays->far - task->before);
    }
    solve(rays, &lanes, v_load(px), v_load(s), v_load(t), &outcome);
    uint32_t n_onwards = 0;
    for (int k = 0; k < n; k++)
        if (conclude(frame, &room->task[which[k]], &room->met[which[k]], &outcome, k, is_last))
            onwards[n_onwards++] = which[k];
    return n_onwards;
}

void LANE_NAME(native_meet)(const struct native_frame *frame, struct native_tile_room *room)
{
    uint32_t n = (uint32_t)room->n_tasks;
    for (uint32_t i = 0; i < n; i++)
        room->active[i] = i;
    for (int i = 0; i < PATCHES && n; i++) {
        uint32_t left = 0;
        for (uint32_t k = 0; k < n; k += LANES)
            left += meet_lanes(frame, room, room->active + k, (int)(n - k < LANES ? n - k : LANES),
                               i == PATCHES - 1, room->active + left);
        n = left;
    }
}

/* --- */

static void write_lane(const struct native_frame *frame, struct native_tile_planes *to,
                       uint32_t pixel, const struct native_met *met, const struct described *found,
                       int k)
{
    const struct limit_node *node = &frame->model->tables->nodes[met->node];
    bool has_normal = !(met->part.at_vertex && node->levels & LIMIT_NO_NORMAL);
    uint32_t at = TILE_PLANE_FIRST + pixel;
    float uv[2];
    native_ptex(node, met->x, met->y, uv);
    to->before[at] = found->before[k];
    to->depth[at] = found->z[k];
    for (int i = 0; i < 3; i++) {
        to->normal[i][at] = has_normal ? found->n[i][k] : 0;
        to->shape[i][at] = found->shape[i][k];
    }
    to->face[at] = (int32_t)node->face;
    to->u[at] = uv[0];
    to->v[at] = uv[1];
    to->border[at] = found->border[k];
    to->node[at] = (int32_t)met->node;
    to->where[at] = (int32_t)native_guess_of(&met->part, node, met->x, met->y);
}

void LANE_NAME(native_write)(const struct native_frame *frame, struct native_tile_room *room,
                             const uint16_t *pixel, const struct native_met *const *met, size_t n)
{
    for (size_t i = 0; i < n; i += LANES) {
        struct lanes lanes;
        float s[LANES], t[LANES];
        int count = n - i < LANES ? (int)(n - i) : LANES;
        for (int k = 0; k < LANES; k++) {
            const struct native_met *own = met[i + (size_t)(k < count ? k : 0)];
            uint32_t p = pixel[i + (size_t)(k < count ? k : 0)];
            const double at_px[2] = {room->tile.x + p % TILE_WIDTH + 0.5,
                                     room->tile.y + p / TILE_WIDTH + 0.5};
            set_met(frame, room, &lanes, k, own, at_px);
            s[k] = own->s;
            t[k] = own->t;
        }
        struct derivatives at;
        struct described found;
        lanes.place.c = (const vfloat(*)[4][4])lanes.c;
        /* No lane may depend on the other lanes. */
        lanes.place.is_turned = lanes.place.any_border = true;
        each_all(&lanes.place, v_load(s), v_load(t), &at);
        each_describe(&lanes.place, &frame->rays, lanes.place.h, lanes.place.k, &at, v_load(s),
                      v_load(t), &found);
        for (int k = 0; k < count; k++)
            write_lane(frame, &room->planes, pixel[i + (size_t)k], met[i + (size_t)k], &found, k);
    }
}
