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
    ivec2 p = list_place(listed.at[min(i, listed.n - 1u)]);
    Shown behind = shown_behind(p);
    shown[local] = Shown(vec4(0.0), 0.0);
    seen_share[local] = 0.0;
    if (is_ray) {
        RoundedHit hit = hits[i * rays + ray];
        vec2 q = pixel_offset(p) + rounded_place(int(ray), side);
        vec3 n = hit.normal_depth.xyz;
        float z = hit.normal_depth.w;
        Sample at = sample_at(q, 1.0 / float(side), z, n, hit.shape.xyz, n);
        Shown there = dot(n, n) > 0.5 ? lay_over(behind, at, meet(at), q) : behind;
        seen_share[local] = float(z > 0.0) / float(rays);
        shown[local] = scaled(there, seen_share[local]);
    }
    barrier();
    if (!is_ray || ray != 0u)
        return;
    Shown sum = Shown(vec4(0.0), 0.0);
    float covered = 0.0;
    for (uint k = local; k < local + rays; k++) {
        sum = added(sum, shown[k]);
        covered += seen_share[k];
    }
    // A ray for which no guess led to the surface shows nothing only where something around does.
    bool beside_empty = false;
    for (int k = 0; k < 9; k++)
        beside_empty = beside_empty || hit_at(p + ivec2(k % 3, k / 3) - 1).depth == 0.0;
    // A sliver that the pixel's centre sees may lie between the rays: then the centre stands for one of them.
    Hit own = hit_at(p);
    if (covered == 0.0 && mirrors(own)) {
        float size = 1.0 / float(side);
        Sample at = sample_at(pixel_offset(p), size, own.depth, own.n, own.h, own.n);
        covered = size * size;
        sum = scaled(lay_over(behind, at, meet(at), pixel_offset(p)), covered);
    }
    float all = beside_empty ? 1.0 : covered;
    if (all == 0.0)
        return;
    put_shown(p, scaled(sum, 1.0 / all), 1.0 - covered / all);
    imageStore(coverage, p, vec4(covered / all));
}
