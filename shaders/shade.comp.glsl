// Stage 3, shade: what the light shows where the line family's ray meets it, averaged over the pixel.
// The formulas are in README.md; rays and lights in lines.glsl, patterns in patterns.glsl.
//
// Light, pattern and colours may change without stages 1 and 2. Several lights are several passes,
// the hindmost first; each blends over what is there.

layout(local_size_x = 64) in;

layout(binding = 0, r32f) readonly uniform image2D hit_depth;
layout(binding = 1, rgba32f) readonly uniform image2D normal;
layout(binding = 2, rg32f) readonly uniform image2D shape;
layout(binding = 3, rgba8) uniform image2D colour;

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    float z = imageLoad(hit_depth, p).x;
    vec4 facing = imageLoad(normal, p);
    vec3 h = vec3(imageLoad(shape, p).xy, facing.w);
    vec2 q = pixel_offset(p);
    Sample at = sample_at(q, 1.0, z, facing.xyz, h, facing.xyz);
    Met met = meet(at);
#ifdef UNFILTERED  // one sample a pixel
    met.ds = met.dt = met.dtau = vec2(0.0);
    met.cover = float(met.inside);
#endif
    vec4 under = is_hindmost ? miss : imageLoad(colour, p);
    bool hit = z > 0.0, mirrors = dot(facing.xyz, facing.xyz) > 0.5;
    // A place without a normal mirrors nothing.
    imageStore(colour, p, !hit ? empty : !mirrors ? miss : lay_over(under, at, met, q));
}
