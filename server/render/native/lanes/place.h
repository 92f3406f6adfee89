/* A ray and a sub-patch: derivatives, and the results of stage 2 at the place where they meet (shaders/surface.glsl,
 * shaders/planes.glsl).
 *
 * This file is included twice: with T as float, for lanes that all have the same patch, and with T as vfloat, where
 * each lane has its own; NAMED gives the two sets of names. */

/* A patch in a view. Lengths are in units of its scale; the ray's two planes are as in newton.glsl. */
struct NAMED(place) {
    const T (*c)[4][4];     /* native_patch.c */
    T h[3], k[3];           /* the planes' normals in the node's frame */
    T l[3];                 /* the view axis in the node's frame */
    T a, b;                 /* distances of the node's origin from the planes */
    T z, before;            /* the node's origin: depth, and distance from the far depth */
    T scale, inverse_scale; /* units */
    T bend;                 /* native_patch.bend */
    T lost;                 /* lost_square() */
    T axes[3][3];           /* the node's frame; columns are its axes in the world */
    bool is_turned;         /* the frame is not the world's */
    /* For the border: the parameters change up_x and up_y times as fast as x and y of the node, and begin at x0, y0.
     * For each edge of the node: the number of the node's cells between it and the face's edge, the width of the
     * rounding, both in the node's size, and whether there is a border. */
    T up_x, up_y, x0, y0, beyond[4], rounding[4];
    T has_border[4]; /* 1 or 0 */
    bool any_border;
};

/* One coordinate at s, t and its first derivatives. */
LANE_INLINE struct flat_value NAMED(flat)(const T c[4][4], vfloat s, vfloat t)
{
    vfloat b[4], d[4];
    for (int j = 0; j < 4; j++) {
        vfloat b2 = c[j][3] * s + c[j][2], b1 = b2 * s + c[j][1], d1 = c[j][3] * s + b2;
        b[j] = b1 * s + c[j][0];
        d[j] = d1 * s + b1;
    }
    vfloat b2 = b[3] * t + b[2], b1 = b2 * t + b[1], d1 = b[3] * t + b2;
    return (struct flat_value){b1 * t + b[0], ((d[3] * t + d[2]) * t + d[1]) * t + d[0],
                               d1 * t + b1};
}

/* The place at s, t with its first, second and third derivatives. */
LANE_INLINE void NAMED(all)(const struct NAMED(place) * place, vfloat s, vfloat t,
                            struct derivatives *at)
{
    for (int k = 0; k < 3; k++) {
        vfloat b[4], d[4], e[4];
        for (int j = 0; j < 4; j++) {
            const T *c = place->c[k][j];
            vfloat b2 = c[3] * s + c[2], b1 = b2 * s + c[1], d1 = c[3] * s + b2;
            b[j] = b1 * s + c[0];
            d[j] = d1 * s + b1;
            e[j] = c[3] * s + d1; /* half the second derivative */
        }
        vfloat b2 = b[3] * t + b[2], b1 = b2 * t + b[1], d1 = b[3] * t + b2;
        at->p[k] = b1 * t + b[0];
        at->t[k] = d1 * t + b1;
        vfloat d2 = d[3] * t + d[2], d3 = d2 * t + d[1], d4 = d[3] * t + d2;
        at->s[k] = d3 * t + d[0];
        at->st[k] = d4 * t + d3;
        vfloat e2 = e[3] * t + e[2], e3 = e2 * t + e[1];
        at->half_ss[k] = e3 * t + e[0];
        at->half_tt[k] = b[3] * t + d1;
        at->half_sst[k] = (e[3] * t + e2) * t + e3;
        at->half_stt[k] = d[3] * t + d4;
        const T(*c)[4] = place->c[k];
        at->sixth_sss[k] = ((c[3][3] * t + c[2][3]) * t + c[1][3]) * t + c[0][3];
        at->sixth_ttt[k] = b[3];
    }
}

/* Moves the derivatives from a place to one a step further; exact except for fourth derivatives. */
LANE_INLINE void NAMED(move)(struct derivatives *at, vfloat ds, vfloat dt)
{
    vfloat half_ds = 0.5f * ds, half_dt = 0.5f * dt;
    for (int k = 0; k < 3; k++) {
        vfloat ss = 3 * ds * at->sixth_sss[k] + dt * at->half_sst[k]; /* half of the change */
        vfloat st = ds * at->half_sst[k] + dt * at->half_stt[k];
        vfloat tt = ds * at->half_stt[k] + 3 * dt * at->sixth_ttt[k];
        vfloat s = ds * (2 * at->half_ss[k] + ss) + dt * (at->st[k] + st);
        vfloat t = ds * (at->st[k] + st) + dt * (2 * at->half_tt[k] + tt);
        at->p[k] += ds * at->s[k] + dt * at->t[k] + half_ds * s + half_dt * t;
        at->s[k] += s;
        at->t[k] += t;
        at->half_ss[k] += ss;
        at->st[k] += 2 * st;
        at->half_tt[k] += tt;
    }
}

/* limit_normal() of surface.glsl, in the node's frame. */
LANE_INLINE void NAMED(normal)(const struct NAMED(place) * place, const struct derivatives *at,
                               vfloat s, vfloat t, vfloat n[3], vfloat *area2)
{
    v_cross(at->s, at->t, n);
    *area2 = v_dot(n, n);
    vfloat s2 = v_dot(at->s, at->s), t2 = v_dot(at->t, at->t);
    vfloat most = v_max(s2, t2);
    vmask lost =
        v_less(v_min(s2, t2), place->lost * most) | v_not(v_less(1e-24f * s2 * t2, *area2));
    /* The bound is not below the second derivatives. */
    vmask may_vanish = v_less(most, 1e-8f * (place->bend * place->bend) + (vfloat){0});
    if (v_bits(lost | may_vanish)) {
        vfloat ss2 = 4 * v_dot(at->half_ss, at->half_ss), st2 = v_dot(at->st, at->st);
        vfloat tt2 = 4 * v_dot(at->half_tt, at->half_tt), ds[3], dt[3], a[3], b[3];
        vmask both = v_less(most, 1e-8f * v_max(v_max(ss2, tt2), st2));
        vfloat inward_s = 0.5f - s, inward_t = 0.5f - t;
        for (int k = 0; k < 3; k++) {
            ds[k] = 2 * inward_s * at->half_ss[k] + inward_t * at->st[k];
            dt[k] = inward_s * at->st[k] + 2 * inward_t * at->half_tt[k];
        }
        vfloat second[3];
        v_cross(ds, dt, second);
        v_cross(ds, at->t, a);
        v_cross(at->s, dt, b);
        for (int k = 0; k < 3; k++)
            n[k] = v_select(both, second[k], v_select(lost, a[k] + b[k], n[k]));
    }
    vfloat largest = v_max(v_max(v_abs(n[0]), v_abs(n[1])), v_abs(n[2]));
    vmask is_none = v_not(v_less(v_float(0), largest));
    vfloat inverse = 1 / v_select(is_none, v_float(1), largest);
    for (int k = 0; k < 3; k++)
        n[k] *= inverse;
    vfloat to_unit = 1 / v_sqrt(v_select(is_none, v_float(1), v_dot(n, n)));
    for (int k = 0; k < 3; k++)
        n[k] *= to_unit;
}

/* Turns a vector from the node's frame into the world. */
LANE_INLINE void NAMED(turn)(const struct NAMED(place) * place, vfloat v[3])
{
    vfloat x = v[0], y = v[1], z = v[2];
    for (int k = 0; k < 3; k++)
        v[k] = place->axes[k][0] * x + place->axes[k][1] * y + place->axes[k][2] * z;
}

/* shape_operator() of planes.glsl; n becomes the normal in the world. */
LANE_INLINE void NAMED(shape)(const struct NAMED(place) * place, const struct derivatives *at,
                              vfloat area2, vfloat n[3], vfloat shape[3])
{
    vfloat bend[3] = {2 * v_dot(at->half_ss, n), v_dot(at->st, n), 2 * v_dot(at->half_tt, n)};
    vmask has_area = v_less(v_float(0), area2);
    vfloat to_unit = 1 / v_sqrt(v_select(has_area, area2, v_float(1))), to_s[3], to_t[3];
    v_cross(at->t, n, to_s);
    v_cross(n, at->s, to_t);
    for (int k = 0; k < 3; k++) {
        to_s[k] *= to_unit;
        to_t[k] *= to_unit;
    }
    if (place->is_turned) {
        NAMED(turn)(place, to_s);
        NAMED(turn)(place, to_t);
        NAMED(turn)(place, n);
        vfloat length2 = v_dot(n, n);
        vfloat inverse = 1 / v_sqrt(v_select(v_less(v_float(0), length2), length2, v_float(1)));
        for (int k = 0; k < 3; k++)
            n[k] *= inverse;
    }
    vfloat e1[3], e2[3];
    v_tangent_basis(n, e1, e2);
    vfloat a = v_dot(to_s, e1), b = v_dot(to_t, e1), c = v_dot(to_s, e2), d = v_dot(to_t, e2);
    vfloat along_a = bend[0] * a + bend[1] * b, along_b = bend[1] * a + bend[2] * b;
    vfloat along_c = bend[0] * c + bend[1] * d, along_d = bend[1] * c + bend[2] * d;
    vfloat unit = v_select(has_area, place->inverse_scale + (vfloat){0}, v_float(0));
    shape[0] = (a * along_a + b * along_b) * unit;
    shape[1] = (c * along_a + d * along_b) * unit;
    shape[2] = (c * along_c + d * along_d) * unit;
}

/* border_of() of planes.glsl, at (x,y) of the node. px: pixels of a unit of scale. */
LANE_INLINE vint NAMED(border)(const struct NAMED(place) * place, const vfloat h[3],
                               const vfloat k[3], const struct derivatives *at, vfloat x, vfloat y,
                               vfloat px)
{
    vfloat px_x = px * place->up_x, px_y = px * place->up_y;
    vfloat x_x = v_dot(h, at->s) * px_x, x_y = v_dot(k, at->s) * px_x;
    vfloat y_x = v_dot(h, at->t) * px_y, y_y = v_dot(k, at->t) * px_y;
    vfloat area = x_x * y_y - x_y * y_x;
    vfloat by_y = area / v_max(y_x * y_x + y_y * y_y, v_float(1e-30f));
    vfloat by_x = area / v_max(x_x * x_x + x_y * x_y, v_float(1e-30f));
    vfloat to_x[2] = {y_y * by_y, -y_x * by_y}, to_y[2] = {-x_y * by_x, x_x * by_x};
    vfloat foot_x = v_float(BORDER_NONE), foot_y = foot_x, width = v_float(0);
    vmask is_rounded = v_less(foot_x, width);
    for (int e = 0; e < 4; e++) {
        vmask is = v_less(v_float(0), place->has_border[e] + (vfloat){0});
        if (!v_bits(is))
            continue;
        const vfloat *to = e & 1 ? to_x : to_y;
        vfloat away = place->beyond[e] + (e == 0 ? y : e == 1 ? 1 - x : e == 2 ? 1 - y : x);
        vfloat long_px = v_sqrt(to[0] * to[0] + to[1] * to[1]);
        vfloat rounding_px = place->rounding[e] * long_px;
        vfloat beyond_px = (away - place->rounding[e]) * long_px;
        is_rounded = is_rounded | (is & v_at_most(v_float(BORDER_THIN), rounding_px) &
                                   v_less(rounding_px, v_float(BORDER_WIDE)) &
                                   v_less(beyond_px, v_float(BORDER_HALF_PIXEL)));
        vfloat go = v_select(v_less(away, place->rounding[e] + (vfloat){0}), v_float(0), away);
        go = e == 0 || e == 3 ? -go : go;
        vfloat to_foot_x = go * to[0], to_foot_y = go * to[1];
        vmask nearer = is & v_less(rounding_px, v_float(BORDER_THIN)) &
                       v_less(to_foot_x * to_foot_x + to_foot_y * to_foot_y,
                              foot_x * foot_x + foot_y * foot_y);
        foot_x = v_select(nearer, to_foot_x, foot_x);
        foot_y = v_select(nearer, to_foot_y, foot_y);
        width = v_select(nearer, rounding_px, width);
    }
    return v_select_int(is_rounded, v_int(BORDER_ROUNDED), v_pack_border(foot_x, foot_y, width));
}

/* The results of stage 2 at the place s, t with these derivatives. h and k are the ray's planes. */
LANE_INLINE void NAMED(describe)(const struct NAMED(place) * place, const struct native_rays *rays,
                                 const vfloat h[3], const vfloat k[3], const struct derivatives *at,
                                 vfloat s, vfloat t, struct described *out)
{
    vfloat area2;
    NAMED(normal)(place, at, s, t, out->n, &area2);
    NAMED(shape)(place, at, area2, out->n, out->shape);
    vfloat along = place->l[0] * at->p[0] + place->l[1] * at->p[1] + place->l[2] * at->p[2];
    out->z = (place->z + along) * place->scale;
    out->before = (place->before - along) * place->scale;
    out->border = v_int(BORDER_PACKED_NONE);
    out->x = (s + place->x0) / place->up_x;
    out->y = (t + place->y0) / place->up_y;
    if (place->any_border)
        out->border = NAMED(border)(place, h, k, at, out->x, out->y,
                                    place->scale / (out->z * rays->slope_px + rays->start_px));
}
