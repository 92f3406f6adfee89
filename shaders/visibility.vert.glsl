// Stage 1, visibility: draws grids over the parts of the surface that the CPU chose (server/render/patch_grids.h);
// `grid` gives their cells along u and v. One instance draws several grids, since some devices take longer to start
// an instance than to draw a small grid.

layout(binding = TEXTURES_FREE) uniform usamplerBuffer patch_grids;  // node, level | k << 6 | depth << 8, x, y

uniform ivec2 grid;
uniform int first_grid, n_grids;
uniform int grids_per_instance;

flat out uvec2 where;  // node, level
out vec2 st;           // in [0,2]: local coordinates times 2^level

vec3 position_at(Node node, vec2 xy)
{
    SubPatch own = sub_patch_at(node, xy);
    if (own.limit)
        return node.origin;
    Net points;
    float scale;
    fetch_points(own, points, scale);
    return patch_at(node, frame_of(node), points, scale, own.st).s;
}

void main()
{
    int vertices = (grid.x + 1) * (grid.y + 1);
    int index = gl_InstanceID * grids_per_instance + gl_VertexID / vertices;
    int vertex = gl_VertexID % vertices;
    uvec4 own = texelFetch(patch_grids, first_grid + min(index, n_grids - 1));
    int level = int(own.y & 63u);
    uint k = (own.y >> 6) & 3u;
    float size = ldexp(1.0, -int(own.y >> 8 & 0xffu));
    vec2 cell = vec2(vertex % (grid.x + 1), vertex / (grid.x + 1)) / vec2(grid);
    // k = 1,2,3: the three unit squares of a level's ring (a strip has only the third); 0: the
    // square at the origin.
    vec2 square = vec2(k == 1u || k == 2u, k >= 2u);
    st = square + (vec2(own.zw) + cell) * size;

    Node node = node_load(own.x);
    vec3 s = position_at(node, ldexp(st, -level_scale(node, level)));
    where = uvec2(own.x, uint(level));
    float w = is_perspective() ? s.z : 1.0;
    float z = is_perspective() ? depth.x : depth.y + s.z * depth.z;
    // The last instance may have more grids than are left; all vertices of the extra ones fall on one point.
    gl_Position = index < n_grids ? vec4(s.xy * clip.xy + w * clip.zw, z, w) : vec4(0, 0, 0, 1);
}
