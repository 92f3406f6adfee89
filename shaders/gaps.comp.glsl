// Stage 2, evaluate, fourth pass, over the pixels that asked their neighbours: lists those where triangles of stage 1
// may have hidden what the pixel shows.
//
// These triangles reach up to half a pixel beyond the surface's silhouettes and borders. Where two of them leave a
// gap narrower than the pixel, stage 1 may have seen only the triangles, in this pixel and in all around it. Then the
// pixel's ray meets nothing, and no neighbour has seen what lies behind the gap. Such a pixel has hits on two
// opposite sides. Hits of other pixels in gaps do not count, so that the result does not depend on which tile was
// drawn first.

layout(local_size_x = 64) in;

layout(binding = 0, r32f) readonly uniform image2D hit_depth;
layout(binding = 1, rg32ui) uniform uimage2D seen_here;  // the plane `seen` again, to write IN_GAP

LIST(0, Listed, listed);
LIST(3, Gaps, gaps);

const ivec2 ASIDE[4] = ivec2[4](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, -1));

bool is_hit(ivec2 p)
{
    return all(greaterThanEqual(p, ivec2(0))) && all(lessThan(p, tile.zw)) &&
           imageLoad(hit_depth, p).x > 0.0 && !is_in_gap(imageLoad(seen_here, p).x);
}

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    bool between = false;
    for (int k = 0; k < 4; k++)
        between = between || (is_hit(p + ASIDE[k]) && is_hit(p - ASIDE[k]));
    uvec2 own = imageLoad(seen_here, p).xy;
    if (!between || imageLoad(hit_depth, p).x > 0.0 || own.x == UNSEEN)
        return;
    imageStore(seen_here, p, uvec4(own.x | IN_GAP, own.y, 0u, 0u));
    LIST_ADD(gaps, p, 64u)
}
