// Packs and unpacks what the plane `ends` holds of a pixel that shows surface: x, where that piece of surface ends at
// a silhouette; y, where it ends at the nearest border of its Ptex face that counts (border.glsl). An end is a line
// in the picture, of several the one nearest to the pixel's centre: its direction (11 bits), its distance (12 bits),
// the width of a crease's rounding on this side (8 bits), and whether the surface on the other side of a crease shows
// the same face to the eye (1 bit).

const uint NO_END = 0xffffffffu;
const float END_STEPS = 1024.0;  // steps per px
const float NEAREST_END = 1.0 / END_STEPS;
const uint END_GOES_ON = 0x80000000u;

// across: the unit vector towards the line. Its angle is stored as a position on the square |x| + |y| = 1.
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

// The end that stage 2's border gives, exact to first order.
uint end_of_border(uint packed_border)
{
    vec2 foot = border_foot(packed_border);
    if (packed_border == ROUNDED || any(greaterThanEqual(abs(foot), NO_BORDER)))
        return NO_END;
    float off = length(foot);
    return pack_end(off > 0.0 ? foot / off : vec2(1.0, 0.0), off, border_rounding(packed_border));
}
