// The counterpart of wireframe.frag.glsl for processors.

layout(local_size_x = 64) in;

layout(binding = 1, r32f) readonly uniform image2D hit_depth;
layout(binding = 2, rgba8) writeonly uniform image2D colour;

void main()
{
    ivec2 p = row_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (p.x >= tile.z || imageLoad(hit_depth, p).x == 0.0)
        return;
    Triangle t = triangle_of(imageLoad(seen, p).x);
    vec3 shares = shares_at(t, pixel_offset(p)), change_x, change_y;
    share_changes(t, p, shares, change_x, change_y);
    imageStore(colour, p, wireframe_colour(grid_at(t, inside(shares)), grid_at(t, change_x), grid_at(t, change_y),
                                           (t.where.x & FAN) != 0u));
}
