// Stage 2, evaluate, third pass: the pixels that one guess does not serve.
//
// The ray decides coverage: guesses of the pixels around are tried where the pixel has none, where its
// own fails, and where a neighbour lies in front; the nearest solution wins. So a silhouette is where
// the surface ends, and a crack between grids of different fineness cannot show.

layout(local_size_x = 64) in;

const ivec2 AROUND[5] =
    ivec2[5](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= unsolved.n)
        return;
    ivec2 p = list_place(unsolved.at[i]);
    Ray r = ray_of(p);
    Solution best;
    best.found = false;
    for (int k = 0; k < 5; k++) {
        ivec2 q = clamp(p + AROUND[k], ivec2(0), tile.zw - 1);
        uvec2 guess = texelFetch(seen, q, 0).xy;
        if (guess.x == NONE)
            continue;
        Solution other = solve(q, guess, r);
        if (other.found && (!best.found || other.hit.surface.s.z < best.hit.surface.s.z))
            best = other;
    }
    if (best.found)
        store_hit(p, best.hit.node, best.hit.xy, best.hit.steps, best.hit.surface);
    else
        store_miss(p);
}
