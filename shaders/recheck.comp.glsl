// Stage 2, evaluate, third pass, over the groups whose depths are discontinuous: lists the pixels that must ask their
// neighbours. These are empty pixels beside ones that are not, pixels that lie behind a neighbour by more than a
// slope, and pixels that lie behind two opposite neighbours. (Pixels that show surface and are still unsolved are
// already listed by the pass before.)

layout(local_size_x = 64) in;

layout(binding = 0, r32f) readonly uniform image2D hit_depth;

LIST(3, Unsolved, unsolved);

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    float z = imageLoad(hit_depth, p).x, front = nearest_around(p);
    bool is_empty = ndc_at(p) == 0.0;
    if (z > 0.0 ? needs_recheck(front, z) || is_between(p, z) : is_empty && front < FARTHEST)
        LIST_ADD(unsolved, p, 64u)
}
