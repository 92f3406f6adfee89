// Packs and unpacks what the border plane holds of a pixel, in 32 bits: the vector from the pixel's centre to the
// nearest border of the Ptex face seen (px; 12 bits each for x and y), and the width of a crease's rounding on this
// side of that border (px; 8 bits).
//
// Instead of the x of a vector it may hold ROUNDED: the pixel shows the rounding of a crease whose width is between
// THIN and WIDE.

const float BORDER_STEPS = 512.0;          // steps per px
const vec2 NO_BORDER = vec2(2047.0 / 512.0);
const float THIN = 0.5;                    // px: a crease with a wider rounding is no border
const float WIDE = 6.0;                    // px: across a wider rounding the curvature hardly changes within a pixel
const uint ROUNDED = 0x800u;               // a value that x never has

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
