// Stage 2, evaluate, three passes over listed pixels: those that evaluate.comp.glsl lists, then recheck.comp.glsl,
// then gaps.comp.glsl.
//
// First pass: pixels whose guess may lead to another sub-patch; each uses its own guess only. Second pass: the pixels
// that remain, where the ray decides coverage. Guesses of the pixels around are tried where the pixel has no guess,
// where its own fails, and where a neighbour lies in front; the nearest solution wins. So a silhouette is where the
// surface ends, and a crack between grids of different fineness cannot show. Third pass: pixels in gaps, which try
// every piece of the surface that may lie on their ray.

layout(local_size_x = 64) in;

LIST(0, Listed, listed);      // the pixels of this pass
LIST(3, Unsolved, unsolved);  // the first pass adds the pixels of the second

// The guesses of the i-th pixel in a gap are guess_ends[i - 1] (0 for the first pixel) up to guess_ends[i].
layout(std430, binding = 1) readonly buffer GuessEnds {
    uint guess_ends[];
};
layout(std430, binding = 2) readonly buffer Guesses {
    Guess guesses[];
};

uniform int n_asked;  // how many of ASKED to try; 0: the guesses above instead

// The pixel itself comes first; the first pass tries no other.
const ivec2 ASKED[5] =
    ivec2[5](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    Ray r = ray_of(p);
    bool in_gap = n_asked == 0;
    uint first = in_gap && i > 0u ? guess_ends[i - 1u] : 0u;
    uint end = in_gap ? guess_ends[i] : uint(n_asked);
    Solution best;
    best.found = false;
    for (uint k = first; k < end; k++) {
        Guess guess;
        if (in_gap)
            guess = guesses[k];
        else
            guess = guess_of(clamp(p + ASKED[k], ivec2(0), tile.zw - 1));
        Solution other = solve(guess, r);
        if (other.found && (!best.found || other.hit.surface.s.z < best.hit.surface.s.z))
            best = other;
    }
    float z = best.found ? best.hit.surface.s.z : 0.0;
    bool is_settled = best.found && !needs_recheck(nearest_around(p), z) && !is_between(p, z);
    if (n_asked == 1 && !is_settled)
        LIST_ADD(unsolved, p, 64u)
    else if (best.found)
        store_hit(p, best.hit.node, best.hit.xy, best.hit.steps, best.hit.surface);
}
