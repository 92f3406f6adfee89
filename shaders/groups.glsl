// Groups of 4 x 2 pixels that show surface or lie beside some (gather.comp.glsl), x | y << 16 in groups:
// a pass over pixels takes eight groups a workgroup, so that what is empty costs nothing.

const uint GROUPS_PER_ROW = 32768u;  // of workgroups: a dimension may have 65,535

layout(std430, binding = 1) buffer Groups {
    uint x, y, z;  // the dispatch
    uint n;
    uint at[];
} groups;

// The pixel of this invocation; outside the tile where there is none.
ivec2 group_pixel(uvec3 workgroup, uint local)
{
    uint i = 8u * (workgroup.y * GROUPS_PER_ROW + workgroup.x) + local / 8u;
    uint group = groups.at[min(i, groups.n - 1u)];
    ivec2 p = ivec2(group & 0xffffu, group >> 16) * ivec2(4, 2) + ivec2(local % 4u, local / 4u % 2u);
    return i < groups.n ? p : tile.zw;
}
