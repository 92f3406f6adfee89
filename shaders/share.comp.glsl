// Counts the pixels that show surface, and those of them whose reflected ray meets a light. There is one pass for
// each light, from the hindmost; the pass of the foremost adds up. An invocation takes a group of eight pixels and
// looks at one in `stride`.

layout(local_size_x = 8) in;

layout(std430, binding = 3) buffer Share {
    uint seen_px, met_px;
    uint met[];  // per group: one bit for each pixel on which a light is met
};

uniform uint stride;
uniform ivec4 inside;  // x, y, width, height: of the tile without its margin

void main()
{
    uint group = 8u * (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) + gl_LocalInvocationIndex;
    uint seen_here = 0u, met_here = 0u;
    for (uint k = group % stride; k < 8u; k += stride) {
        ivec2 p = group_pixel(gl_WorkGroupID, 8u * gl_LocalInvocationIndex + k);
        Hit hit = hit_at(p);
        ivec2 off = p - inside.xy;
        if (!(hit.depth > 0.0) || any(lessThan(off, ivec2(0))) || any(greaterThanEqual(off, inside.zw)))
            continue;
        seen_here |= 1u << k;
        if (mirrors(hit) && meet(sample_at(pixel_offset(p), 1.0, hit.depth, hit.n, hit.h, hit.n)).inside)
            met_here |= 1u << k;
    }
    if (seen_here == 0u)
        return;
    met_here |= is_hindmost ? 0u : met[group];
    met[group] = met_here;
    if (is_foremost) {
        atomicAdd(seen_px, uint(bitCount(seen_here)));
        atomicAdd(met_px, uint(bitCount(met_here)));
    }
}
