// Stage 2, evaluate, second and last pass: the pixels that evaluate.comp.glsl and doubt.comp.glsl listed.
//
// First those whose guess may lead to another sub-patch: they ask their own. Then what is left, where
// the ray decides coverage: guesses of the pixels around are tried where the pixel has none, where its
// own fails, and where a neighbour lies in front; the nearest solution wins. So a silhouette is where
// the surface ends, and a crack between grids of different fineness cannot show.

layout(local_size_x = 64) in;

LIST(0, Listed, listed);      // this pass's pixels
LIST(3, Unsolved, unsolved);  // those for the last one

uniform bool around;  // the last pass

// The pixel itself first: the second pass asks no other.
const ivec2 ASKED[5] =
    ivec2[5](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    Ray r = ray_of(p);
    Solution best;
    best.found = false;
    for (int k = 0; k < (around ? 5 : 1); k++) {
        ivec2 q = clamp(p + ASKED[k], ivec2(0), tile.zw - 1);
        uvec2 guess = texelFetch(seen, q, 0).xy;
        if (guess.x == NONE)
            continue;
        Solution other = solve(q, guess, r);
        if (other.found && (!best.found || other.hit.surface.s.z < best.hit.surface.s.z))
            best = other;
    }
    float z = best.found ? best.hit.surface.s.z : 0.0;
    bool is_settled = best.found && !is_doubtful(nearest_around(p), z) && !is_between(p, z);
    if (!around && !is_settled)
        LIST_ADD(unsolved, p, 64u)
    else if (best.found)
        store_hit(p, best.hit.node, best.hit.xy, best.hit.steps, best.hit.surface);
}
