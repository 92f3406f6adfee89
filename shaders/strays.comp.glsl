// Stage 2, evaluate, second pass: the pixels whose guess may lead to another sub-patch.

layout(local_size_x = 64) in;

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= strays.n)
        return;
    ivec2 p = list_place(strays.at[i]);
    Solution own = solve(p, texelFetch(seen, p, 0).xy, ray_of(p));
    if (own.found && !is_doubtful(nearest_around(p), own.hit.surface.s.z))
        store_hit(p, own.hit.node, own.hit.xy, own.hit.steps, own.hit.surface);
    else
        LIST_ADD(unsolved, p, 64u)
}
