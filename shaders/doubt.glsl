// The pixels that one pass of stage 2 leaves to the next, and why.

LIST(0, Listed, listed);      // their guess may lead to another sub-patch; or this pass's own pixels
LIST(3, Unsolved, unsolved);  // more than one guess must be asked

const ivec2 BESIDE[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
const float FARTHEST = 1e30;

// The nearest depth of the four pixels around, or FARTHEST.
float nearest_around(ivec2 p)
{
    float ndc = 0.0;
    for (int i = 0; i < 4; i++)
        ndc = max(ndc, texelFetch(seen_depth, clamp(p + BESIDE[i], ivec2(0), tile.zw - 1), 0).x);
    return ndc > 0.0 ? depth_of(ndc) : FARTHEST;
}

// In front by more than a slope of four pixels of depth a pixel: another sheet, or a crack that shows
// what lies behind.
bool is_doubtful(float front, float z)
{
    return front < z - 4.0 * pixel_units(z);
}
