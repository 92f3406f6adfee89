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
vec3 shape_operator(Surface s, vec3 n, vec3 n_world)
{
    vec3 e1, e2;
    tangent_basis(n_world, e1, e2);
    e1 = to_camera(e1);
    e2 = to_camera(e2);
    float e = dot(s.su, s.su), f = dot(s.su, s.sv), g = dot(s.sv, s.sv);
    float area2 = e * g - f * f;
    if (!(area2 > 0.0))
        return vec3(0.0);
    mat2 inverse = mat2(g, -f, -f, e) / area2;
    vec2 a = inverse * vec2(dot(s.su, e1), dot(s.sv, e1));
    vec2 b = inverse * vec2(dot(s.su, e2), dot(s.sv, e2));
    mat2 second = mat2(dot(s.suu, n), dot(s.suv, n), dot(s.suv, n), dot(s.svv, n));
    return vec3(dot(a, second * a), dot(a, second * b), dot(b, second * b)) / s.scale;
}

// The normal at st. Where a derivative vanishes or both are parallel (a collapsed edge, a pole, a
// smooth corner of one quad) its limit from inside the patch, by the second derivatives; zero where
// there is none.
vec3 limit_normal(Surface s, vec2 st)
{
    vec3 n = cross(s.su, s.sv);
    float u2 = dot(s.su, s.su), v2 = dot(s.sv, s.sv);
    bool vanishes = !(dot(n, n) > 1e-8 * u2 * v2) || min(u2, v2) < 1e-8 * max(u2, v2);
    vec2 inward = (0.5 - st) * 0.01;
    vec3 su = s.su + inward.x * s.suu + inward.y * s.suv;
    vec3 sv = s.sv + inward.x * s.suv + inward.y * s.svv;
    n = vanishes ? cross(su, sv) : n;
    float length2 = dot(n, n);
    return length2 > 0.0 ? n * inversesqrt(length2) : vec3(0.0);
}

void store_miss(ivec2 p)
{
    imageStore(position, p, vec4(0.0));
    if (want_ptex)
        imageStore(ptex, p, uvec4(NONE, floatBitsToUint(vec2(0.0)), 0u));
}

void store_hit(ivec2 p, Surface s, vec2 st, uint face, vec2 uv)
{
    vec3 n = limit_normal(s, st);
    vec3 n_world = dot(n, n) > 0.0 ? normalize(to_world(n)) : vec3(0.0);
    vec3 h = shape_operator(s, n, n_world);
    imageStore(position, p, vec4(to_world(s.s), s.s.z));
    imageStore(normal, p, vec4(n_world, h.z));
    imageStore(shape, p, vec4(h.xy, 0.0, 0.0));
    if (want_ptex)
        imageStore(ptex, p, uvec4(face, floatBitsToUint(uv), 0u));
}
