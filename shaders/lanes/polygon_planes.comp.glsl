// The counterpart of polygon.frag.glsl for processors.

layout(local_size_x = 64) in;

layout(binding = 1, r32f) writeonly uniform image2D hit_depth;
layout(binding = 2, rgba32f) writeonly uniform image2D normal;
layout(binding = 3, rg32f) writeonly uniform image2D shape;
layout(binding = 4, rgba32ui) writeonly uniform uimage2D ptex;

void main()
{
    ivec2 p = row_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (p.x >= tile.z)
        return;
    uint number = imageLoad(seen, p).x;
    if (number == NOTHING) {
        imageStore(hit_depth, p, vec4(0.0));
        return;
    }
    Triangle t = triangle_of(number);
    vec3 shares = shares_at(t, pixel_offset(p)), share = inside(shares), change_x, change_y;
    share_changes(t, p, shares, change_x, change_y);
    vec3 facing = facing_at(t, share);
    float z = share.x * t.at[0].z + share.y * t.at[1].z + share.z * t.at[2].z, size = length(facing);
    bool has_normal = size > 0.0;
    vec3 n = has_normal ? facing / size : vec3(0.0);
    vec3 h = has_normal ? polygon_shape(n, size, z, pixel_offset(p), facing_at(t, change_x),
                                        facing_at(t, change_y))
                        : vec3(0.0);
    imageStore(hit_depth, p, vec4(z));
    imageStore(normal, p, vec4(n, h.z));
    imageStore(shape, p, vec4(h.xy, 0.0, 0.0));
    imageStore(ptex, p, uvec4(t.where.x & ~FAN, floatBitsToUint(grid_at(t, share) / float(t.where.y)), 0u));
}
