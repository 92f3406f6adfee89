// Writes the planes of stages 1 and 2 (planes.glsl) from position and normal interpolated over the triangle.

in vec3 seen_at;
in vec3 facing;
in vec2 grid;
flat in uvec2 where;

layout(location = 0) out float hit_depth;
layout(location = 1) out vec4 normal;
layout(location = 2) out vec2 shape;
layout(location = 3) out uvec4 ptex;

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = dot(axis[2].xyz, seen_at), size = length(facing);
    bool has_normal = size > 0.0;
    vec3 n = has_normal ? facing / size : vec3(0.0);
    vec3 h = has_normal ? polygon_shape(n, size, z, pixel_offset(p), dFdxFine(facing), dFdyFine(facing))
                        : vec3(0.0);
    hit_depth = z;
    normal = vec4(n, h.z);
    shape = h.xy;
    ptex = uvec4(where.x & ~FAN, floatBitsToUint(grid / float(where.y)), 0u);
}
