// Reads the limit tables (server/surface/tables.h) from buffer textures. A table larger than one buffer texture is
// spread over several banks of BANK_TEXELS texels.
//
// On processors (MADE_PATCHES) `texels` holds no table: makeTexels(texels, node, part) computes the points of a
// node's sub-patch and returns their index, valid until the next call; `heads` holds the nodes' frames.
//
// The including program defines POINT_BANKS, NODE_BANKS, ADJACENCY_BANKS, BANK_TEXELS, and NODE_BANK_TEXELS, which
// keeps the three texels of a node in one bank.

const uint NONE = 0xffffffffu;
const uint REGULAR = 0u, CORNER = 1u, SPLIT = 2u, HOLE = 3u, STRIP = 4u;
const uint PATCH_TEXELS = 13u, LEVEL_TEXELS = 18u;  // server/surface/texels.h
const uint NO_NORMAL = 0x80u;
const uint BORDER_SHARP = 15u;

layout(binding = 0) uniform samplerBuffer texels[POINT_BANKS];
#ifdef MADE_PATCHES
uniform samplerBuffer heads;
#endif
layout(binding = POINT_BANKS) uniform usamplerBuffer nodes[NODE_BANKS];
layout(binding = POINT_BANKS + NODE_BANKS) uniform usamplerBuffer adjacency[ADJACENCY_BANKS];

// Samplers may not be indexed by a value that differs between invocations, hence these chains of conditions.
#define LADDER(i, size)                                                                            \
    uint bank = (i) / uint(size);                                                                  \
    int at = int((i) - bank * uint(size));

vec4 texel_at(uint i)
{
#if POINT_BANKS == 1
    return texelFetch(texels[0], int(i));
#else
    LADDER(i, BANK_TEXELS)
    if (bank == 0u)
        return texelFetch(texels[0], at);
    if (bank == 1u)
        return texelFetch(texels[1], at);
#if POINT_BANKS > 2
    if (bank == 2u)
        return texelFetch(texels[2], at);
#endif
#if POINT_BANKS > 3
    if (bank == 3u)
        return texelFetch(texels[3], at);
#endif
#if POINT_BANKS > 4
    if (bank == 4u)
        return texelFetch(texels[4], at);
#endif
#if POINT_BANKS > 5
    if (bank == 5u)
        return texelFetch(texels[5], at);
#endif
#if POINT_BANKS > 6
    if (bank == 6u)
        return texelFetch(texels[6], at);
#endif
    return texelFetch(texels[POINT_BANKS - 1], at);
#endif
}

uvec4 node_texel(uint i)
{
#if NODE_BANKS == 1
    return texelFetch(nodes[0], int(i));
#else
    LADDER(i, NODE_BANK_TEXELS)
    if (bank == 0u)
        return texelFetch(nodes[0], at);
#if NODE_BANKS > 2
    if (bank == 1u)
        return texelFetch(nodes[1], at);
#endif
#if NODE_BANKS > 3
    if (bank == 2u)
        return texelFetch(nodes[2], at);
#endif
    return texelFetch(nodes[NODE_BANKS - 1], at);
#endif
}

uvec4 adjacency_of(uint face)
{
#if ADJACENCY_BANKS == 1
    return texelFetch(adjacency[0], int(face));
#else
    LADDER(face, BANK_TEXELS)
    if (bank == 0u)
        return texelFetch(adjacency[0], at);
    return texelFetch(adjacency[ADJACENCY_BANKS - 1], at);
#endif
}

struct Node {
#ifdef MADE_PATCHES
    uint index;
#endif
    uint first;
    uint face;
    uvec2 cell;
    uint kind;
    uint depth;
    uint rotation;
    uint borders;     // four bits a local edge of the cell's Ptex face: BORDER_SHARP
    int levels;       // STRIP: number of patches less one; CORNER: number of rings towards the vertex
    bool has_normal;  // CORNER: at the vertex itself
    uint ngon_size, ngon_corner;
    vec3 origin;  // relative to the eye, in camera space
};

Node node_load(uint i)
{
    uvec4 a = node_texel(3u * i), b = node_texel(3u * i + 1u), c = node_texel(3u * i + 2u);
    Node node;
#ifdef MADE_PATCHES
    node.index = i;
#endif
    // The difference is computed in double precision, so that nothing is lost far from the world's origin.
    dvec3 origin = dvec3(packDouble2x32(a.xy), packDouble2x32(a.zw), packDouble2x32(b.xy));
    node.origin = to_camera(vec3(origin - eye.xyz));
    node.first = b.z;
    node.face = b.w;
    node.cell = uvec2(c.x & 0xffffu, c.x >> 16);
    node.kind = c.y & 0xffu;
    node.depth = (c.y >> 8) & 0xffu;
    node.rotation = (c.y >> 16) & 0xffu;
    node.levels = int((c.y >> 24) & ~NO_NORMAL);
    node.has_normal = ((c.y >> 24) & NO_NORMAL) == 0u;
    node.ngon_size = c.z;
    node.ngon_corner = c.w & 0xffffu;
    node.borders = (c.w >> 16 | c.w & 0xffff0000u) >> 4u * node.rotation & 0xffffu;
    return node;
}
