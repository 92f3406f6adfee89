// What a rounded pixel shows: the mean of what its rays' parts of it show. One invocation a ray.

layout(local_size_x = 64) in;

layout(binding = 5, r32f) writeonly uniform image2D coverage;

layout(std430, binding = 2) readonly buffer RoundedHits {
    RoundedHit hits[];
};

shared Shown shown[64];
shared float seen_share[64];

void main()
{
    uint local = gl_LocalInvocationIndex, ray = local % MAX_RAYS;
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * ROUNDED_PER_GROUP + local / MAX_RAYS;
    int side = rounded_side(listed.n);
    uint rays = uint(side * side);
    bool is_ray = i < listed.n && ray < rays;
    uint listed_pixel = listed.at[min(i, listed.n - 1u)];
    ivec2 p = rounded_pixel(listed_pixel);
    RoundedHit hit = hits[is_ray ? i * rays + ray : 0u];
    vec2 q = pixel_offset(p) + rounded_place(int(ray), side, rounded_at_edge(listed_pixel));
    seen_share[local] = is_ray && hit.normal_depth.w > 0.0 ? 1.0 / float(rays) : 0.0;
    barrier();
    uint first = local - ray;
    float covered = 0.0;
    for (uint k = first; k < first + rays; k++)
        covered += seen_share[k];
    // A sliver that the pixel's centre sees may lie between the rays: then the centre stands for one of them.
    Hit own = hit_at(p);
    bool is_sliver = covered == 0.0 && mirrors(own);
    float share = is_sliver && ray == 0u ? 1.0 / float(rays) : seen_share[local];
    if (is_sliver) {
        hit = RoundedHit(vec4(own.n, own.depth), vec4(own.h, 0.0));
        q = pixel_offset(p);
        covered = 1.0 / float(rays);
    }
    Shown behind = shown_behind(p);
    vec3 n = hit.normal_depth.xyz;
    Sample at = sample_at(q, 1.0 / float(side), hit.normal_depth.w, n, hit.shape.xyz, n);
    shown[local] = scaled(dot(n, n) > 0.5 ? lay_over(behind, at, meet(at), q) : behind, share);
    barrier();
    if (!is_ray || ray != 0u)
        return;
    Shown sum = Shown(vec4(0.0), 0.0);
    for (uint k = first; k < first + rays; k++)
        sum = added(sum, shown[k]);
    // A ray for which no guess led to the surface shows nothing only where something around does.
    bool beside_empty = false;
    for (int k = 0; k < 9; k++)
        beside_empty = beside_empty || hit_at(p + ivec2(k % 3, k / 3) - 1).depth <= 0.0;
    float all = beside_empty ? 1.0 : covered;
    if (all == 0.0)
        return;
    put_shown(p, scaled(sum, 1.0 / all), 1.0 - covered / all);
    imageStore(coverage, p, vec4(covered / all));
}
