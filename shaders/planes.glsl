// What stage 2 writes for each pixel, for stage 3 and for the caller.

// Relative to the eye, world axes; w: depth along the view axis, 0 where nothing is hit.
layout(binding = 0, rgba32f) writeonly uniform image2D position;
// Unit, along the winding; w: shape operator entry (2,2).
layout(binding = 1, rgba32f) writeonly uniform image2D normal;
// Shape operator entries (1,1) and (1,2) in the basis tangent_basis(normal), 1/unit.
layout(binding = 2, rg32f) writeonly uniform image2D shape;
layout(binding = 3, rgba32ui) writeonly uniform uimage2D ptex;

layout(binding = TEXTURES_FREE) uniform usampler2D seen;
layout(binding = TEXTURES_FREE + 1) uniform sampler2D seen_depth;

uniform bool want_ptex;

// Pixels that the first pass of stage 2 leaves to the second: x | y << 16. The first three words
// are the second pass's dispatch.
layout(std430, binding = 0) buffer Unsolved {
    uint groups_x, groups_y, groups_z;
    uint n_unsolved;
    uint unsolved[];
};

float depth_of(float ndc)
{
    return is_perspective() ? depth.x / ndc : (ndc - depth.y) / depth.z;
}

// Second fundamental form over first, in the basis of basis.glsl.
vec3 shape_operator(Surface s, vec3 n_world)
{
    if (!(s.area2 > 0.0))
        return vec3(0.0);
    vec3 e1, e2;
    tangent_basis(n_world, e1, e2);
    e1 = to_camera(e1);
    e2 = to_camera(e2);
    float e = dot(s.su, s.su), f = dot(s.su, s.sv), g = dot(s.sv, s.sv);
    mat2 inverse = mat2(g, -f, -f, e) / s.area2;
    vec2 a = inverse * vec2(dot(s.su, e1), dot(s.sv, e1));
    vec2 b = inverse * vec2(dot(s.su, e2), dot(s.sv, e2));
    mat2 second =
        mat2(dot(s.suu, s.n), dot(s.suv, s.n), dot(s.suv, s.n), dot(s.svv, s.n));
    return vec3(dot(a, second * a), dot(a, second * b), dot(b, second * b)) / s.scale;
}

void store_miss(ivec2 p)
{
    imageStore(position, p, vec4(0.0));
    if (want_ptex)
        imageStore(ptex, p, uvec4(NONE, floatBitsToUint(vec2(0.0)), 0u));
}

void store_hit(ivec2 p, Surface s, uint face, vec2 uv)
{
    vec3 n = dot(s.n, s.n) > 0.0 ? normalize(to_world(s.n)) : vec3(0.0);
    vec3 h = shape_operator(s, n);
    imageStore(position, p, vec4(to_world(s.s), s.s.z));
    imageStore(normal, p, vec4(n, h.z));
    imageStore(shape, p, vec4(h.xy, 0.0, 0.0));
    if (want_ptex)
        imageStore(ptex, p, uvec4(face, floatBitsToUint(uv), 0u));
}
