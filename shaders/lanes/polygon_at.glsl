// Interpolates over the triangle that a pixel shows, without a rasteriser: for processors, which have determined the
// triangle before (server/render/native/lanes/triangles.c).

layout(binding = 0, rg32ui) readonly uniform uimage2D seen;  // x: the triangle
uniform samplerBuffer vertices;                              // mesh_vertex of server/render/mesh.h, two texels each
layout(std430, binding = 0) readonly buffer Corners {
    uint corner[];                                           // three vertices of each triangle
};
uniform vec3 centre;                                         // of the mesh, camera space

const uint NOTHING = 0xffffffffu;

// A workgroup takes 64 pixels of a row. A pixel beyond the tile's right end is not drawn.
ivec2 row_pixel(uvec3 workgroup, uint local)
{
    uint per_row = (uint(tile.z) + 63u) / 64u, i = workgroup.y * 32768u + workgroup.x;
    return ivec2(i % per_row * 64u + local, i / per_row);
}

struct Triangle {
    vec3 at[3];      // camera space
    vec3 facing[3];  // unit normals, world
    vec2 grid[3];    // in cells
    uvec2 where;     // mesh_vertex.face, and its cells along an edge
};

Triangle triangle_of(uint number)
{
    Triangle t;
    for (int k = 0; k < 3; k++) {
        int first = 2 * int(corner[3u * number + uint(k)]);
        vec4 a = texelFetch(vertices, first), b = texelFetch(vertices, first + 1);
        uint cell = floatBitsToUint(b.w);
        t.at[k] = to_camera(a.xyz) + centre;
        t.facing[k] = vec3(a.w, b.xy);
        t.grid[k] = vec2(cell & 255u, cell >> 8 & 255u);
        t.where = uvec2(floatBitsToUint(b.z), cell >> 16 & 255u);
    }
    return t;
}

float across(vec2 a, vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

// The weight of each corner's values where the ray of q meets the triangle's plane: the mean of the corners with
// these weights lies on the ray. This also holds for corners behind the eye.
vec3 shares_at(Triangle t, vec2 q)
{
    vec2 a = t.at[0].xy - q * pixel_units(t.at[0].z), b = t.at[1].xy - q * pixel_units(t.at[1].z);
    vec2 c = t.at[2].xy - q * pixel_units(t.at[2].z);
    vec3 share = vec3(across(b, c), across(c, a), across(a, b));
    float all = share.x + share.y + share.z;
    return all != 0.0 ? share / all : vec3(1.0 / 3.0);
}

// A ray that misses the triangle only by rounding counts as meeting it.
vec3 inside(vec3 shares)
{
    vec3 share = max(shares, 0.0);
    return share / (share.x + share.y + share.z);
}

vec3 facing_at(Triangle t, vec3 share)
{
    return share.x * t.facing[0] + share.y * t.facing[1] + share.z * t.facing[2];
}

vec2 grid_at(Triangle t, vec3 share)
{
    return share.x * t.grid[0] + share.y * t.grid[1] + share.z * t.grid[2];
}

// How the shares change by a pixel to the right and a pixel down: the difference from the other pixel of the same
// pair, as by dFdxFine() and dFdyFine().
void share_changes(Triangle t, ivec2 p, vec3 share, out vec3 change_x, out vec3 change_y)
{
    vec2 q = pixel_offset(p), to = 1.0 - 2.0 * vec2((p + tile.xy) & 1);
    change_x = (shares_at(t, q + vec2(to.x, 0.0)) - share) * to.x;
    change_y = (shares_at(t, q + vec2(0.0, to.y)) - share) * to.y;
}
