// Groups of 4 x 2 pixels that show surface or lie beside some (gather.comp.glsl), x | y << 16 in groups:
// a pass over pixels takes eight groups a workgroup, so that what is empty costs nothing.

LIST(1, Groups, groups);

// The pixel of this invocation; outside the tile where there is none.
ivec2 group_pixel(uvec3 workgroup, uint local)
{
    uint i = 8u * (workgroup.y * ROW + workgroup.x) + local / 8u;
    uint group = groups.at[min(i, groups.n - 1u)];
    ivec2 p = list_place(group) * ivec2(4, 2) + ivec2(local % 4u, local / 4u % 2u);
    return i < groups.n ? p : tile.zw;
}
