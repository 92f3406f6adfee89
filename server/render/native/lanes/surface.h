/* Evaluates the limit surface in lanes. */
#ifndef SHEEN_RENDER_NATIVE_LANES_SURFACE_H
#define SHEEN_RENDER_NATIVE_LANES_SURFACE_H

#include <stdbool.h>

#include "server/render/native/frame.h"
#include "server/render/native/lanes.h"

/* Position and derivatives by the parameters of a sub-patch, in its node's frame, in units of its scale. */
struct derivatives {
    vfloat p[3], s[3], t[3], half_ss[3], st[3], half_tt[3];
    vfloat sixth_sss[3], half_sst[3], half_stt[3], sixth_ttt[3];
};

/* One coordinate of a place, and its derivatives. */
struct flat_value {
    vfloat f, s, t;
};

/* The results of stage 2 at a place (native.h). */
struct described {
    vfloat z, before, n[3], shape[3], x, y; /* x, y: on the node */
    vint border;
};

LANE_INLINE vfloat v_dot(const vfloat a[3], const vfloat b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LANE_INLINE void v_cross(const vfloat a[3], const vfloat b[3], vfloat out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* shaders/basis.glsl */
LANE_INLINE void v_tangent_basis(const vfloat n[3], vfloat e1[3], vfloat e2[3])
{
    vfloat sign = v_select(v_at_most(v_float(0), n[2]), v_float(1), v_float(-1));
    vfloat a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    e1[0] = 1 + sign * n[0] * n[0] * a;
    e1[1] = sign * b;
    e1[2] = -sign * n[0];
    e2[0] = b;
    e2[1] = sign + n[1] * n[1] * a;
    e2[2] = -n[1];
}

/* shaders/border.glsl */
#define BORDER_STEPS 512.0f
#define BORDER_NONE (2047.0f / 512)
#define BORDER_THIN 0.5f
#define BORDER_WIDE 6.0f
#define BORDER_HALF_PIXEL 0.71f
#define BORDER_ROUNDED 0x800
#define BORDER_PACKED_NONE (0x7ff | 0x7ff << 12)

LANE_INLINE vint v_pack_border(vfloat foot_x, vfloat foot_y, vfloat width)
{
    vint x = v_round(v_clamp(foot_x, -BORDER_NONE, BORDER_NONE) * BORDER_STEPS);
    vint y = v_round(v_clamp(foot_y, -BORDER_NONE, BORDER_NONE) * BORDER_STEPS);
    vint w = v_round(width * (255 / BORDER_THIN));
    return (x & 0xfff) | (y & 0xfff) << 12 | w << 24;
}

/* The distance from the ray, px, that counts as on it (close_enough() of newton.glsl). */
LANE_INLINE vfloat v_close_enough(vfloat px_per_scale)
{
    return v_max(v_float(0.0005f), 1.5e-7f * px_per_scale);
}

#define T float
#define NAMED(name) one_##name
#include "server/render/native/lanes/place.h"
#undef T
#undef NAMED
#define T vfloat
#define NAMED(name) each_##name
#include "server/render/native/lanes/place.h"
#undef T
#undef NAMED

/* Packs a start for Newton's method as in shaders/visibility.frag.glsl: the node's coordinates times 2^level, in [0,
 * 2]. */
LANE_INLINE vint v_guess(vfloat s, vfloat t, int32_t level)
{
    const float steps = 8191.0f / 2;
    vint q = v_truncate(v_clamp(s, 0, 2) * steps + 0.5f);
    vint r = v_truncate(v_clamp(t, 0, 2) * steps + 0.5f);
    return level | q << 6 | r << 19;
}

#endif
