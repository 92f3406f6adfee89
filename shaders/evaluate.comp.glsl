// Stage 2, evaluate, first pass: finds where each pixel's own ray meets the limit surface.
//
// The rasterised parameters belong to the triangle; used as they are they would cost up to 0.2 degrees. Newton's
// method starts from them and finds those of the pixel's ray (server/surface/README.md 7.1). This pass stays inside
// the guessed sub-patch, which is enough for nearly all pixels. The others, next to borders of sub-patches, are
// listed for unsolved.comp.glsl, so that no pixel pays for rare cases on devices whose lanes all execute every
// branch.

layout(local_size_x = 64) in;

LIST(0, Listed, listed);

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
    bool solved = is_seen && residual < close_enough(px_per_scale) && inside && s.s.z > 0.0 &&
                  !own.limit && abs(s.s.z - z) < STRAY * pixel_units(z);
    if (solved)
        store_hit(p, node, ldexp(own.origin + own.st, -own.scale), own.scale, s);
    else if (is_seen)
        LIST_ADD(listed, p, 64u)
}
