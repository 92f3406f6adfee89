// Stage 3 for callers who measure: writes, at the pixel's centre, where the foremost light is met, how that changes
// from pixel to pixel, and the surface's principal curvatures. It is a pass apart from shade.comp.glsl because few
// pictures need these planes, and some devices take as long for a skipped store as for a real one.

layout(local_size_x = 64) in;

layout(binding = 4, rg32f) writeonly uniform image2D light_st;
layout(binding = 5, rg32f) writeonly uniform image2D curvature;
layout(binding = 6, rgba32f) writeonly uniform image2D light_change;

// This is a function and no global constant: not every compiler accepts uintBitsToFloat() in a constant expression.
vec4 nothing()
{
    return vec4(uintBitsToFloat(0x7fc00000u));
}

vec2 principal_curvatures(vec3 h)
{
    float mean = 0.5 * (h.x + h.z), radius = length(vec2(0.5 * (h.x - h.z), h.y));
    return vec2(mean - radius, mean + radius);
}

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    Hit hit = hit_at(p);
    Met met = meet(sample_at(pixel_offset(p), 1.0, hit.depth, hit.n, hit.h, hit.n));
    bool inside = mirrors(hit) && met.cover > 0.0 && met.inside;
    if (want.x != 0)
        imageStore(light_st, p, inside ? (met.q / size.xy + 0.5).xyxy : nothing());
    if (want.y != 0)
        imageStore(curvature, p, mirrors(hit) ? principal_curvatures(hit.h).xyxy : nothing());
    if (want.z != 0)
        imageStore(light_change, p, inside ? vec4(met.ds, met.dt) / size.xxyy : nothing());
}
