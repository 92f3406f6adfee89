// Reads what stage 1 wrote for each pixel, and decides from the depths around a pixel whether it needs a recheck.

layout(binding = TEXTURES_FREE) uniform usampler2D seen;  // visibility.frag.glsl
layout(binding = TEXTURES_FREE + 1) uniform sampler2D seen_depth;  // 0 where nothing is seen

// Values of seen.x: UNSEEN, nothing is seen; the bit IN_GAP beside a node, the pixel is in a gap (gaps.comp.glsl).
const uint UNSEEN = 0xffffffffu, IN_GAP = 0x80000000u;

bool is_in_gap(uint seen_node)
{
    return seen_node != UNSEEN && (seen_node & IN_GAP) != 0u;
}

float depth_of(float ndc)
{
    return is_perspective() ? depth.x / ndc : (ndc - depth.y) / depth.z;
}

const ivec2 BESIDE[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
const float FARTHEST = 1e30;

float ndc_at(ivec2 p)
{
    return texelFetch(seen_depth, clamp(p, ivec2(0), tile.zw - 1), 0).x;
}

float front_of(float ndc)
{
    return ndc > 0.0 ? depth_of(ndc) : FARTHEST;
}

// The nearest depth of the four neighbours, or FARTHEST.
float nearest_around(ivec2 p)
{
    float ndc = 0.0;
    for (int i = 0; i < 4; i++)
        ndc = max(ndc, ndc_at(p + BESIDE[i]));
    return front_of(ndc);
}

// Whether `front` is in front of z by more than a slope of four pixels of depth per pixel: then it is another sheet,
// or this pixel sees through a crack in it.
bool needs_recheck(float front, float z)
{
    return front < z - 4.0 * pixel_units(z);
}

// Whether the pixel lies behind two opposite neighbours by more than a pixel's depth. Then a crack between grids may
// show a sheet that is too close behind the first one for needs_recheck() to notice.
bool is_between(ivec2 p, float z)
{
    float behind = z - pixel_units(z);
    for (int i = 0; i < 4; i += 2)
        if (max(front_of(ndc_at(p + BESIDE[i])), front_of(ndc_at(p + BESIDE[i + 1]))) < behind)
            return true;
    return false;
}

// Where the depths of stage 1 slope by less than CALM, a solution within STRAY of the depth of stage 1 needs no
// recheck. So the pixels of calm groups (gather.comp.glsl) need not ask their neighbours.
const float CALM = 1.0, STRAY = 2.0;
