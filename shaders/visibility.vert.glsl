// Stage 1, visibility: grids over the pieces of the surface that the CPU chose
// (server/gpu/pieces.h). One instance is one piece; the grid has GRID x GRID cells.

layout(location = 0) in uvec4 piece;  // node, level | k << 6 | depth << 8, x, y

uniform int grid;

flat out uvec2 where;  // node, level
out vec2 st;           // in [0,2]: local coordinates times 2^level

vec3 position_at(Node node, vec2 xy)
{
    SubPatch own = sub_patch_at(node, xy);
    if (own.limit)
        return node.origin;
    vec3 p[16];
    float scale;
    fetch_points(own, p, scale);
    return patch_at(node, frame_of(node), p, scale, own.st).s;
}

void main()
{
    int level = int(piece.y & 63u);
    uint k = (piece.y >> 6) & 3u;
    float size = ldexp(1.0, -int(piece.y >> 8));
    vec2 cell = vec2(gl_VertexID % (grid + 1), gl_VertexID / (grid + 1)) / float(grid);
    // k = 1,2,3: the three unit squares of a level's ring (a strip has only the third); 0: the
    // square at the origin.
    vec2 square = vec2(k == 1u || k == 2u, k >= 2u);
    st = square + (vec2(piece.zw) + cell) * size;

    Node node = node_load(piece.x);
    vec3 s = position_at(node, ldexp(st, -level_scale(node, level)));
    where = uvec2(piece.x, uint(level));
    float w = is_perspective() ? s.z : 1.0;
    float z = is_perspective() ? depth.x : depth.y + s.z * depth.z;
    gl_Position = vec4(s.xy * clip.xy + w * clip.zw, z, w);
}
