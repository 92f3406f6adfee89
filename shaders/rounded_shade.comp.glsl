// Shades the pixels of rounded.glsl: each shows the mean of its rays' parts. One invocation per pixel.

layout(local_size_x = 64) in;

layout(binding = 5, r32f) writeonly uniform image2D coverage;

layout(std430, binding = 2) readonly buffer RoundedHits {
    RoundedHit hits[];
};

// Whether nothing is met at the pixel or at one around it; beyond the picture nothing is met.
bool is_beside_empty(ivec2 p)
{
    bool is = any(lessThan(p, ivec2(1))) || any(greaterThanEqual(p + 1, tile.zw));
    for (int k = 0; k < 9 && !is; k++)
        is = imageLoad(hit_depth, clamp(p + ivec2(k % 3, k / 3) - 1, ivec2(0), tile.zw - 1)).x == 0.0;
    return is;
}

void main()
{
    // There are as many workgroups as rounded_solve needs for rays, so most have no pixel.
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    int side = rounded_side(listed.n), rays = side * side;
    if (i >= listed.n || rays == 0)
        return;
    uint listed_pixel = listed.at[i];
    bool at_edge = rounded_at_edge(listed_pixel);
    ivec2 p = rounded_pixel(listed_pixel);
    vec2 centre = pixel_offset(p);
    Shown behind = shown_behind(p), sum = Shown(vec4(0.0), 0.0);
    float share = 1.0 / float(rays), covered = 0.0;
    for (int ray = 0; ray <= rays; ray++) {
        RoundedHit hit = hits[i * uint(rays) + uint(min(ray, rays - 1))];
        vec2 q = centre;
        if (ray < rays)
            q += rounded_place(ray, side, at_edge);
        else if (covered == 0.0) {
            // A sliver that the pixel's centre sees may lie between the rays: then the centre takes the place of one of them.
            Hit own = hit_at(p);
            hit = RoundedHit(vec4(own.n, mirrors(own) ? own.depth : 0.0), vec4(own.h, 0.0));
        }
        if (hit.normal_depth.w == 0.0 || (ray == rays && covered > 0.0))
            continue;
        vec3 n = hit.normal_depth.xyz;
        Sample at = sample_at(q, 1.0 / float(side), hit.normal_depth.w, n, hit.shape.xyz, n);
        Shown shown = behind;
        if (dot(n, n) > 0.5)
            shown = lay_over(behind, at, meet(at), q);
        sum = added(sum, scaled(shown, share));
        covered += share;
    }
    // A ray for which no guess led to the surface counts as empty only if some pixel around is empty.
    float all = is_beside_empty(p) ? 1.0 : covered;
    if (all == 0.0)
        return;
    put_shown(p, scaled(sum, 1.0 / all), 1.0 - covered / all);
    imageStore(coverage, p, vec4(covered / all));
}
