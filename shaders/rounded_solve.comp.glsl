// Meets the rays of the pixels that edges_find.comp.glsl listed as rounded with the surface: with the piece
// that the pixel itself shows, and with those of the pixels towards which the ray lies where it meets
// none or one lies in front. One invocation a ray.

layout(local_size_x = 64) in;

LIST(0, Listed, listed);

layout(std430, binding = 2) writeonly buffer RoundedHits {
    RoundedHit hits[];
};

void main()
{
    uint group = gl_WorkGroupID.y * ROW + gl_WorkGroupID.x;
    uint i = group * ROUNDED_PER_GROUP + gl_LocalInvocationIndex / MAX_RAYS;
    uint part = gl_LocalInvocationIndex % MAX_RAYS;
    int side = rounded_side(listed.n);
    if (i >= listed.n || part >= uint(side * side))
        return;
    ivec2 p = list_place(listed.at[i]);
    vec2 place = rounded_place(int(part), side);
    Ray r = ray_through(pixel_offset(p) + place);
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
    RoundedHit hit = RoundedHit(vec4(0.0), vec4(0.0));
    if (best.found) {
        Surface s = best.hit.surface;
        vec3 n = dot(s.n, s.n) > 0.0 ? normalize(to_world(s.n)) : vec3(0.0);
        hit = RoundedHit(vec4(n, s.s.z), vec4(shape_operator(s, n), 0.0));
    }
    hits[i * uint(side * side) + part] = hit;
}
