// What the border plane holds: from the pixel's centre to the nearest border of the piece seen, px, in
// 12 bits each for x and y; and how wide the rounding of a crease there is on this side, px, in 8.
// Or ROUNDED: the pixel shows the rounding of a crease that is between THIN and WIDE.

const float BORDER_STEPS = 512.0;          // a px
const vec2 NO_BORDER = vec2(2047.0 / 512.0);
const float THIN = 0.5;                    // px: what is rounded more widely is no border
const float WIDE = 6.0;                    // px: across which the curvature hardly changes in a pixel
const uint ROUNDED = 0x800u;               // no foot's x

uint pack_border(vec2 foot, float rounding)
{
    ivec2 q = ivec2(round(clamp(foot, -NO_BORDER, NO_BORDER) * BORDER_STEPS));
    return uint(q.x & 0xfff) | uint(q.y & 0xfff) << 12 | uint(round(rounding / THIN * 255.0)) << 24;
}

vec2 border_foot(uint packed_border)
{
    int bits = int(packed_border);
    return vec2(bits << 20 >> 20, bits << 8 >> 20) / BORDER_STEPS;
}

float border_rounding(uint packed_border)
{
    return float(packed_border >> 24) * (THIN / 255.0);
}
