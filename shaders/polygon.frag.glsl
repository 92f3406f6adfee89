// Polygons instead of the surface (--surface polygon:LEVEL): what stages 1 and 2 would write, from
// position and normal interpolated over the triangle. See planes.glsl for the planes.

const uint FAN = 0x80000000u;

in vec3 seen_at;
in vec3 facing;
in vec2 grid;
flat in uvec2 where;

layout(location = 0) out float hit_depth;
layout(location = 1) out vec4 normal;
layout(location = 2) out vec2 shape;
layout(location = 3) out uvec4 ptex;

// How the interpolated normal n = N / |N| turns from pixel to pixel, as the shape operator that would
// turn it so: for both pixel steps h . dx = -dn, dx being the step in the plane across n that stage 3
// takes. The normal of no surface, so h need not be symmetric: its symmetric part.
vec3 shape_operator(vec3 n, float size, float z, vec2 q)
{
    vec3 e1, e2;
    tangent_basis(n, e1, e2);
    vec3 change[2] = vec3[2](dFdxFine(facing), dFdyFine(facing));
    vec3 d = to_world(vec3(q * ray.x, 1.0));
    mat2 steps, turns;
    for (int i = 0; i < 2; i++) {
        vec3 raw = axis[i].xyz * pixel_units(z);
        vec3 dx = raw - d * (dot(raw, n) / dot(d, n));
        steps[i] = vec2(dot(dx, e1), dot(dx, e2));
        turns[i] = -vec2(dot(change[i], e1), dot(change[i], e2)) / size;
    }
    mat2 h = turns * inverse(steps);
    bool is_known = abs(dot(d, n)) > 0.0 && abs(determinant(steps)) > 0.0;
    return is_known ? vec3(h[0][0], 0.5 * (h[0][1] + h[1][0]), h[1][1]) : vec3(0.0);
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = dot(axis[2].xyz, seen_at), size = length(facing);
    bool has_normal = size > 0.0;
    vec3 n = has_normal ? facing / size : vec3(0.0);
    vec3 h = has_normal ? shape_operator(n, size, z, pixel_offset(p)) : vec3(0.0);
    hit_depth = z;
    normal = vec4(n, h.z);
    shape = h.xy;
    ptex = uvec4(where.x & ~FAN, floatBitsToUint(grid / float(where.y)), 0u);
}
