// Stage 2, evaluate, first pass: where each pixel's own ray meets the limit surface.
//
// The rasterised parameters belong to the triangle and would cost up to 0.2 degrees; Newton's method
// from there makes them the pixel's (limit-surface 3.4). This pass stays inside the guessed
// sub-patch, which serves nearly all pixels; the others (next to silhouettes, cracks and borders
// of sub-patches) are listed for unsolved.comp.glsl. So no pixel pays for the rare cases, on
// devices whose lanes all walk through every branch.

layout(local_size_x = 64) in;

const ivec2 AROUND[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

// The nearest depth of the four pixels around, or a huge one.
float nearest_around(ivec2 p)
{
    float ndc = 0.0;
    for (int i = 0; i < 4; i++)
        ndc = max(ndc, texelFetch(seen_depth, clamp(p + AROUND[i], ivec2(0), tile.zw - 1), 0).x);
    return ndc > 0.0 ? depth_of(ndc) : 1e30;
}

void list_unsolved(ivec2 p)
{
    uint slot = atomicAdd(n_unsolved, 1u);
    if ((slot & 63u) == 0u)
        atomicAdd(groups_x, 1u);
    unsolved[slot] = uint(p.x) | uint(p.y) << 16;
}

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    uvec2 guess = texelFetch(seen, p, 0).xy;
    bool is_seen = guess.x != NONE;
    Node node = node_load(is_seen ? guess.x : 0u);
    SubPatch own = sub_patch_at(node, guess_xy(node, guess.y));
    mat3 frame = frame_of(node);
    Net points;
    float scale;
    fetch_points(own, points, scale);
    FlatNet net = project(node, frame, points, scale, ray_of(p));
    float z = depth_of(texelFetch(seen_depth, p, 0).x);
    float px_per_scale = scale / pixel_units(z);
    float residual = solve_patch(net, px_per_scale, own.st);
    Surface s = patch_at(node, frame, points, scale, own.st);

    bool inside = all(greaterThanEqual(own.st, vec2(0.0))) && all(lessThanEqual(own.st, vec2(1.0)));
    bool solved = is_seen && residual < close_enough(px_per_scale) && inside && s.s.z > 0.0 && !own.limit;
    // In front by more than a slope of four pixels of depth a pixel: another sheet, or a crack
    // that shows what lies behind. Empty pixels ask their neighbours too.
    float front = nearest_around(p);
    bool doubtful = is_seen ? front < s.s.z - 4.0 * pixel_units(s.s.z) : front < 1e30;
    if (solved && !doubtful) {
        vec2 xy = ldexp(own.origin + own.st, -own.scale);
        store_hit(p, node, xy, own.scale, s);
    } else if (is_seen || doubtful) {
        list_unsolved(p);
    } else {
        store_miss(p);
    }
}
