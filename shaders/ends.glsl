// What the plane of ends holds of a pixel that shows surface: where that piece of surface ends at a silhouette (x), and
// where at the nearest border of its Ptex face that counts (y; border.glsl). An end is a line in the picture, the nearest
// to the pixel's centre: which way it lies in 11 bits, how far in 12, how wide a crease there is rounded on this side
// in 8, and whether the surface on a crease's other side shows the same face to the eye.

const uint NO_END = 0xffffffffu;
const float END_STEPS = 1024.0;  // a px
const float NEAREST_END = 1.0 / END_STEPS;
const uint END_GOES_ON = 0x80000000u;

// across: unit, towards the line. Its angle is kept as a place on the square |x| + |y| = 1.
uint pack_end(vec2 across, float off, float rounding)
{
    float t = across.y / (abs(across.x) + abs(across.y));
    t = across.x < 0.0 ? 2.0 - t : t;  // [-1, 3]
    uint turn = uint(round((t + 1.0) * 511.5)), far = uint(round(off * END_STEPS));
    return far > 4095u ? NO_END : turn | far << 11 | uint(round(rounding / THIN * 255.0)) << 23;
}

vec2 end_across(uint end)
{
    float t = float(end & 0x7ffu) / 511.5 - 1.0;
    vec2 on_square = t < 1.0 ? vec2(1.0 - abs(t), t) : vec2(abs(t - 2.0) - 1.0, 2.0 - t);
    return normalize(on_square);
}

float end_off(uint end)
{
    return float(end >> 11 & 0xfffu) / END_STEPS;
}

float end_rounding(uint end)
{
    return float(end >> 23 & 0xffu) * (THIN / 255.0);
}

// Of stage 2's border: to first order.
uint end_of_border(uint packed_border)
{
    vec2 foot = border_foot(packed_border);
    if (packed_border == ROUNDED || any(greaterThanEqual(abs(foot), NO_BORDER)))
        return NO_END;
    float off = length(foot);
    return pack_end(off > 0.0 ? foot / off : vec2(1.0, 0.0), off, border_rounding(packed_border));
}
