// Finds where the rays of rounded pixels (rounded.glsl) meet the surface. One invocation per ray.
//
// A ray starts from the piece that the pixel itself shows. Where it meets none, or a neighbouring pixel's piece lies
// in front, it also starts from the pixels on the side to which the ray lies. A ray that still meets nothing starts
// again, up to twice, from where the rays beside it in the same pixel have met the surface: Newton's method that
// starts a whole pixel away may not get across creases and small sub-patches.

layout(local_size_x = 64) in;

LIST(0, Listed, listed);

layout(std430, binding = 2) writeonly buffer RoundedHits {
    RoundedHit hits[];
};

// The hits of this workgroup's rays.
shared bool is_met[64];
shared Place met_at[64];
shared float met_depth[64];

void put_met(uint local, Solution solution)
{
    is_met[local] = solution.found;
    if (solution.found) {
        met_at[local] = place_of(solution.hit.node, solution.hit.xy);
        met_depth[local] = solution.hit.surface.s.z;
    }
}

const ivec2 RAYS_BESIDE[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

Solution solve_from_beside(uint local, int part, int side, Ray r)
{
    Solution result;
    result.found = false;
    for (int k = 0; k < 4 && !result.found; k++) {
        ivec2 at = ivec2(part % side, part / side) + RAYS_BESIDE[k];
        bool is_inside = min(at.x, at.y) >= 0 && max(at.x, at.y) < side;
        uint beside = local + uint(is_inside ? at.y * side + at.x - part : 0);
        if (!is_met[beside])
            continue;
        Node node;
        vec2 xy;
        node_under(met_at[beside], node, xy);
        result = solve_from(node, xy, met_depth[beside], r);
    }
    return result;
}

// The nearest solution that starts from what the centres of pixels show.
Solution solve_from_centres(ivec2 p, vec2 place, Ray r)
{
    float front = nearest_around(p);
    Solution best;
    best.found = false;
    ivec2 towards = ivec2(sign(place));
    for (int k = 0; k < 4; k++) {
        ivec2 q = clamp(p + ivec2(k & 1, k >> 1) * towards, ivec2(0), tile.zw - 1);
        Solution other = solve(guess_of(q), r);
        if (other.found && (!best.found || other.hit.surface.s.z < best.hit.surface.s.z))
            best = other;
        if (best.found && !needs_recheck(front, best.hit.surface.s.z))
            break;
    }
    return best;
}

void main()
{
    uint group = gl_WorkGroupID.y * ROW + gl_WorkGroupID.x, local = gl_LocalInvocationIndex;
    uint i = group * ROUNDED_PER_GROUP + local / MAX_RAYS, part = local % MAX_RAYS;
    int side = rounded_side(listed.n);
    bool is_ray = i < listed.n && part < uint(side * side);
    uint listed_pixel = listed.at[min(i, listed.n - 1u)];
    ivec2 p = rounded_pixel(listed_pixel);
    vec2 place = rounded_place(int(part), max(side, 1), rounded_at_edge(listed_pixel));
    Ray r = ray_through(pixel_offset(p) + place);
    Solution best;
    best.found = false;
    if (is_ray)
        best = solve_from_centres(p, place, r);
    put_met(local, best);
    barrier();
    if (is_ray && !best.found) {
        best = solve_from_beside(local, int(part), side, r);
        put_met(local, best);
    }
    barrier();
    if (is_ray && !best.found)
        best = solve_from_beside(local, int(part), side, r);
    RoundedHit hit = RoundedHit(vec4(0.0), vec4(0.0));
    if (best.found) {
        Surface s = best.hit.surface;
        vec3 n = dot(s.n, s.n) > 0.0 ? normalize(to_world(s.n)) : vec3(0.0);
        hit = RoundedHit(vec4(n, s.s.z), vec4(shape_operator(s, n), 0.0));
    }
    if (is_ray)
        hits[i * uint(side * side) + part] = hit;
}
