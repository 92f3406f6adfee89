// Stage 3, shade: what the light shows where the line family's ray meets it, averaged over the pixel.
// The formulas are in README.md; rays and lights in lines.glsl, patterns in patterns.glsl.
//
// Light, pattern and colours may change without stages 1 and 2. Several lights are several passes,
// the hindmost first; each blends over what is there.

layout(local_size_x = 64) in;

layout(binding = 0, rgba32f) readonly uniform image2D position;
layout(binding = 1, rgba32f) readonly uniform image2D normal;
layout(binding = 2, rg32f) readonly uniform image2D shape;
layout(binding = 3, rgba8) uniform image2D colour;
layout(binding = 4, rg32f) writeonly uniform image2D light_st;
layout(binding = 5, rg32f) writeonly uniform image2D curvature;
layout(binding = 6, rgba32f) writeonly uniform image2D light_change;

const vec4 NONE = vec4(uintBitsToFloat(0x7fc00000u));

void store_planes(ivec2 p, vec2 st, vec4 change, vec2 k)
{
    if (want.x != 0)
        imageStore(light_st, p, vec4(st, 0.0, 0.0));
    if (want.y != 0)
        imageStore(curvature, p, vec4(k, 0.0, 0.0));
    if (want.z != 0)
        imageStore(light_change, p, change);
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
    vec4 place = imageLoad(position, p);
    vec4 facing = imageLoad(normal, p);
    bool hit = place.w > 0.0, mirrors = dot(facing.xyz, facing.xyz) > 0.5;
    if (!hit || !mirrors) {  // a place without a normal mirrors nothing
        imageStore(colour, p, hit ? miss : empty);
        store_planes(p, NONE.xy, NONE, NONE.xy);
        return;
    }
    vec2 q = pixel_offset(p);
    vec3 h = vec3(imageLoad(shape, p).xy, facing.w);
    Sample at = sample_at(q, 1.0, place, facing.xyz, h, facing.xyz);
    Met met = meet(at);
    vec4 change = vec4(met.ds, met.dt) / size.xxyy;
#ifdef UNFILTERED  // one sample a pixel
    met.ds = met.dt = met.dtau = vec2(0.0);
    met.cover = float(met.inside);
#endif
    vec4 under = is_hindmost ? miss : imageLoad(colour, p);
    imageStore(colour, p, lay_over(under, at, met, q));
    bool inside = met.cover > 0.0 && met.inside;
    store_planes(p, inside ? met.q / size.xy + 0.5 : NONE.xy, inside ? change : NONE,
                 principal_curvatures(at.h));
}
