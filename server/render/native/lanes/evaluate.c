/* Stage 2, first pass (shaders/evaluate.comp.glsl): solves each pixel's ray on the sub-patch of its guess. All pixels
 * of a piece share one patch, whose coefficients are the same in all lanes. */
#include "server/render/native/lanes/stages.h"

#include <math.h>
#include <string.h>

/* After a larger step derivatives are computed again. */
static const float MOST_STEP = 1.0f / 512;
static const float STRAY_PX = 2; /* seen.glsl */
enum { MOST_STEPS = 5 };

/* A piece in the tile being drawn. */
struct piece_view {
    struct one_place place;
    const struct limit_node *node;
    float flat_x[4][4], flat_y[4][4]; /* the patch's distances from the ray of (at_x, at_y) */
    float at_x, at_y;                 /* a place in the tile, px */
    float start;                      /* the rays' start_px, in units of scale */
    float s, t, step;                 /* origin of its guesses on the patch, and their unit */
    float cell_x, cell_y, size;       /* of the node in its Ptex face */
    int32_t number, level;            /* of the node, and of its sub-patch */
};

static void place_borders(const struct limit_node *node, struct one_place *place)
{
    struct native_borders borders;
    place->any_border = node->borders;
    if (!place->any_border)
        return;
    native_borders_of(node, &borders);
    memcpy(place->has_border, borders.is, sizeof borders.is);
    memcpy(place->beyond, borders.beyond, sizeof borders.beyond);
    memcpy(place->rounding, borders.rounding, sizeof borders.rounding);
}

/* Sets the piece's patch as seen from the ray through the middle of its box. */
static void place_piece(const struct native_frame *frame, struct native_tile_room *room,
                        struct native_piece *piece, struct piece_view *view)
{
    const struct native_patch *patch = native_patch_of_piece(frame, room, piece);
    const struct limit_node *node = &frame->model->tables->nodes[piece->node];
    struct one_place *place = &view->place;
    struct native_seen_node seen;
    native_see_node(frame, node, &seen);
    double x_px = (piece->x0 + piece->x1) / 2 + 0.5, y_px = (piece->y0 + piece->y1) / 2 + 0.5;
    double q_x = x_px - frame->view->centre_px[0], q_y = y_px - frame->view->centre_px[1];
    double slope = frame->view->perspective ? frame->view->units_per_px : 0;
    double start = frame->view->perspective ? 0 : frame->view->units_per_px;
    double inverse = (double)patch->inverse_scale;
    int level = piece->level, scale_x = node->kind == LIMIT_CORNER ? level : 0;
    int scale_y = node->kind == LIMIT_REGULAR ? 0 : level;
    place->c = patch->c;
    for (int k = 0; k < 3; k++) {
        place->h[k] = (float)((double)seen.camera[0][k] - q_x * slope * (double)seen.camera[2][k]);
        place->k[k] = (float)((double)seen.camera[1][k] - q_y * slope * (double)seen.camera[2][k]);
        place->l[k] = seen.camera[2][k];
    }
    place->a = (float)((seen.at[0] - q_x * (start + slope * seen.at[2])) * inverse);
    place->b = (float)((seen.at[1] - q_y * (start + slope * seen.at[2])) * inverse);
    place->z = (float)(seen.at[2] * inverse);
    place->before = (float)(seen.before * inverse);
    place->scale = patch->scale;
    place->inverse_scale = (float)inverse;
    place->bend = patch->bend;
    place->is_turned = seen.is_turned;
    place->lost = place->is_turned ? 1e-13f : 1e-8f;
    memcpy(place->axes, seen.axes, sizeof seen.axes);
    place->up_x = (float)native_power(scale_x);
    place->up_y = (float)native_power(scale_y);
    place->x0 = piece->square == 1 || piece->square == 2;
    place->y0 = piece->square >= 2;
    place_borders(node, place);
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            const float p[3] = {patch->c[0][j][i], patch->c[1][j][i], patch->c[2][j][i]};
            view->flat_x[j][i] = place->h[0] * p[0] + place->h[1] * p[1] + place->h[2] * p[2];
            view->flat_y[j][i] = place->k[0] * p[0] + place->k[1] * p[1] + place->k[2] * p[2];
        }
    }
    view->flat_x[0][0] += place->a;
    view->flat_y[0][0] += place->b;
    view->node = node;
    view->number = (int32_t)piece->node;
    view->level = node->kind == LIMIT_REGULAR ? 0 : piece->level;
    view->at_x = (float)(x_px - room->tile.x - 0.5);
    view->at_y = (float)(y_px - room->tile.y - 0.5);
    view->start = (float)(start * inverse);
    view->s = piece->s;
    view->t = piece->t;
    view->step = piece->size / 65535;
    view->cell_x = (float)(node->cell & 0xffff);
    view->cell_y = (float)(node->cell >> 16);
    view->size = (float)native_power(-node->depth);
}

LANE_INLINE void write(struct native_tile_room *room, const struct piece_view *view, vint pixel,
                       unsigned lanes, const struct described *found)
{
    struct native_tile_planes *to = &room->planes;
    vint base = pixel - v_count() + TILE_PLANE_FIRST, face = v_int((int32_t)view->node->face);
    vfloat u, v;
    switch (view->node->rotation) {
    case 0:
        u = found->x, v = found->y;
        break;
    case 1:
        u = 1 - found->y, v = found->x;
        break;
    case 2:
        u = 1 - found->x, v = 1 - found->y;
        break;
    default:
        u = found->y, v = 1 - found->x;
    }
    vint guess = v_guess(found->x * view->place.up_x, found->y * view->place.up_y, view->level);
    u = (u + view->cell_x) * view->size;
    v = (v + view->cell_y) * view->size;
    /* Neighbouring pixels with the same base are written together. */
    int32_t bases[LANES];
    v_store_int(bases, base);
    vmask asked = v_mask(lanes);
    for (unsigned left = lanes; left;) {
        int at = bases[__builtin_ctz(left)];
        vmask run = v_equal_int(base, v_int(at)) & asked;
        left &= ~v_bits(run);
        v_store_masked(to->before + at, run, found->before);
        v_store_masked(to->depth + at, run, found->z);
        for (int k = 0; k < 3; k++) {
            v_store_masked(to->normal[k] + at, run, found->n[k]);
            v_store_masked(to->shape[k] + at, run, found->shape[k]);
        }
        v_store_int_masked(to->face + at, run, face);
        v_store_masked(to->u + at, run, u);
        v_store_masked(to->v + at, run, v);
        v_store_int_masked(to->border + at, run, found->border);
        v_store_int_masked(to->node + at, run, v_int(view->number));
        v_store_int_masked(to->where + at, run, guess);
    }
}

/* The pixels' rays, as two planes in the node's frame (newton.glsl). */
struct pixel_rays {
    vfloat h[3], k[3], a, b;
};

LANE_INLINE struct pixel_rays rays_of(const struct native_rays *rays, const struct piece_view *view,
                                      vint pixel)
{
    vfloat x = v_to_float(pixel & (TILE_WIDTH - 1)) - view->at_x;
    vfloat y = v_to_float(v_shift_right(pixel, __builtin_ctz(TILE_WIDTH))) - view->at_y;
    vfloat slope_x = x * rays->slope_px, slope_y = y * rays->slope_px;
    struct pixel_rays ray;
    for (int k = 0; k < 3; k++) {
        ray.h[k] = view->place.h[k] - slope_x * view->place.l[k];
        ray.k[k] = view->place.k[k] - slope_y * view->place.l[k];
    }
    ray.a = view->place.a - slope_x * view->place.z - x * view->start;
    ray.b = view->place.b - slope_y * view->place.z - y * view->start;
    return ray;
}

struct step {
    vfloat s, t, f_x, f_y; /* f: distance from the ray before the step */
    vmask touches;
};

/* One step of Newton's method, limited to half a sub-patch. */
LANE_INLINE struct step step_of(const struct flat_value *x, const struct flat_value *y)
{
    struct step step = {.f_x = x->f, .f_y = y->f};
    vfloat det = x->s * y->t - y->s * x->t, inverse = 1 / det;
    step.touches =
        v_at_most(v_abs(det), 1e-7f * (x->s * x->s + y->s * y->s + x->t * x->t + y->t * y->t));
    step.s = v_clamp((y->f * x->t - x->f * y->t) * inverse, -0.5f, 0.5f);
    step.t = v_clamp((x->f * y->s - y->f * x->s) * inverse, -0.5f, 0.5f);
    return step;
}

LANE_INLINE struct step step_from(const struct pixel_rays *ray, const struct derivatives *at)
{
    const struct flat_value x = {v_dot(ray->h, at->p) + ray->a, v_dot(ray->h, at->s),
                                 v_dot(ray->h, at->t)};
    const struct flat_value y = {v_dot(ray->k, at->p) + ray->b, v_dot(ray->k, at->s),
                                 v_dot(ray->k, at->t)};
    return step_of(&x, &y);
}

LANE_INLINE vmask is_inside(vfloat s, vfloat t)
{
    return v_at_most(v_float(0), v_min(s, t)) & v_at_most(v_max(s, t), v_float(1));
}

/* Solves LANES pixels of a piece. Returns those that stray. */
LANE_INLINE unsigned solve(const struct native_frame *frame, struct native_tile_room *room,
                           const struct piece_view *view, vint pixel, vint guess, unsigned lanes)
{
    const struct one_place *place = &view->place;
    const struct native_rays *rays = &frame->rays;
    const struct pixel_rays ray = rays_of(rays, view, pixel);
    vint row = v_shift_right(pixel, __builtin_ctz(TILE_WIDTH));
    vint column = pixel & (TILE_WIDTH - 1);
    vint at = row * SEEN_PITCH + column + (APRON * SEEN_PITCH + APRON);
    vfloat seen = v_before(rays, v_gather(room->nearness, at));
    vfloat px = (rays->far - seen) * rays->slope_px + rays->start_px;
    vfloat px_per_scale = place->scale / px, enough = v_close_enough(px_per_scale);
    /* What a step's square leaves is at most half of the bend's: that far from the ray, or half as
     * near. */
    vfloat most2 =
        v_min(enough / (px_per_scale * place->bend + 1e-30f), v_float(MOST_STEP * MOST_STEP));
    vfloat s = v_to_float(guess & 0xffff) * view->step + view->s;
    vfloat t = v_to_float(v_shift_right(guess, 16)) * view->step + view->t;
    /* The first step as if all of the patch were as deep as what is seen: then the pixel's ray is as
     * far from the place's as the pixel is, all over. */
    struct flat_value x = one_flat((const float(*)[4])view->flat_x, s, t);
    struct flat_value y = one_flat((const float(*)[4])view->flat_y, s, t);
    vfloat unit = px * place->inverse_scale;
    x.f -= (v_to_float(column) - view->at_x) * unit;
    y.f -= (v_to_float(row) - view->at_y) * unit;
    struct step step = step_of(&x, &y);
    s += step.s;
    t += step.t;
    struct derivatives near;
    vmask is_far;
    for (int i = 1;; i++) {
        one_all(place, s, t, &near);
        step = step_from(&ray, &near);
        vfloat longest = v_max(v_abs(step.s), v_abs(step.t));
        is_far = v_not(v_at_most(longest * longest, most2));
        if (!(v_bits(is_far) & lanes) || i == MOST_STEPS)
            break;
        /* Lanes that are near stay as they are: no pixel may depend on its neighbours. */
        s = v_select(is_far, v_clamp(s + step.s, -1, 2), s);
        t = v_select(is_far, v_clamp(t + step.t, -1, 2), t);
    }
    /* A place on the ray that would leave the sub-patch by its last step stays. */
    vfloat off2 = step.f_x * step.f_x + step.f_y * step.f_y;
    vmask stays = v_less(off2 * (px_per_scale * px_per_scale), enough * enough) & is_inside(s, t) &
                  v_not(is_inside(s + step.s, t + step.t));
    step.s = v_select(stays, v_float(0), step.s);
    step.t = v_select(stays, v_float(0), step.t);
    one_move(&near, step.s, step.t);
    s += step.s;
    t += step.t;
    struct described found;
    one_describe(place, rays, ray.h, ray.k, &near, s, t, &found);
    vmask solved = is_inside(s, t) & v_not(is_far | step.touches) & v_less(v_float(0), found.z) &
                   v_less(v_abs(found.before - seen), STRAY_PX * px);
    unsigned good = v_bits(solved) & lanes;
    write(room, view, pixel, good, &found);
    return lanes & ~good;
}

/* Lists in `order` the pieces that some pixel shows. Returns their number. */
static size_t list_shown(struct native_tile_room *room)
{
    size_t n = 0;
    for (uint32_t l = 0; l < room->n_local; l++)
        if (room->count[l] != room->count[l + 1])
            room->order[n++] = l;
    return n;
}

/* Pieces and their patches are scattered in memory, so they are fetched some time before use. */
static void fetch_ahead(const struct native_tile_room *room, size_t i, size_t n)
{
    enum { PIECE_AHEAD = 8, PATCH_AHEAD = 3 };
    if (i + PIECE_AHEAD < n)
        __builtin_prefetch(room->local[room->order[i + PIECE_AHEAD]]);
    const struct native_patch *patch =
        i + PATCH_AHEAD < n ? native_piece_patch(room->local[room->order[i + PATCH_AHEAD]]) : NULL;
    for (int line = 0; patch && line < 4; line++)
        __builtin_prefetch((const char *)patch + 64 * line);
}

void LANE_NAME(native_evaluate)(const struct native_frame *frame, struct native_tile_room *room)
{
    struct piece_view view;
    memset(&view, 0, sizeof view);
    size_t n = list_shown(room);
    for (size_t k = 0; k < n; k++) {
        uint32_t l = room->order[k], i = room->count[l], end = room->count[l + 1];
        struct native_piece *piece = room->local[l];
        fetch_ahead(room, k, n);
        if (piece->kind != PIECE_OF_PATCH) { /* each pixel has its own sub-patch */
            for (; i < end; i++)
                room->stray[room->n_strays++] = room->pixel[i];
            continue;
        }
        place_piece(frame, room, piece, &view);
        for (; i < end; i += LANES) {
            unsigned strays = solve(frame, room, &view, v_load_u16(room->pixel + i),
                                    v_load_int(room->guess + i), v_first(end - i));
            for (; strays; strays &= strays - 1)
                room->stray[room->n_strays++] = room->pixel[i + (uint32_t)__builtin_ctz(strays)];
        }
    }
}
