// The blocks of 8 x 8 pixels that may be covered, x | y << 16 in blocks (server/gpu/pieces.h): one
// workgroup each, so that empty parts of the picture cost nothing.
layout(std430, binding = 1) readonly buffer Blocks {
    uint blocks[];
};

// The pixel of this invocation; outside the tile for some of the last blocks.
ivec2 block_pixel(uvec3 group, uvec3 local, uvec3 groups)
{
    uint block = blocks[group.y * groups.x + group.x];
    return ivec2(block & 0xffffu, block >> 16) * 8 + ivec2(local.xy);
}
