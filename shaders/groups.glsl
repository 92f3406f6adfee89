// Groups of 4 x 2 pixels in which a pixel shows surface or lies beside one that does (gather.comp.glsl), as x | y <<
// 16 in groups. A pass over pixels takes eight groups per workgroup, so empty parts of a tile cost nothing.

LIST(1, Groups, groups);

// The pixel of this invocation; a pixel outside the tile if the invocation has none.
ivec2 group_pixel(uvec3 workgroup, uint local)
{
    uint i = 8u * (workgroup.y * ROW + workgroup.x) + local / 8u;
    uint group = groups.at[min(i, groups.n - 1u)];
    ivec2 p = list_place(group) * ivec2(4, 2) + ivec2(local % 4u, local / 4u % 2u);
    return i < groups.n ? p : tile.zw;
}
