// After stage 1: lists the groups of 4 x 2 pixels of which one is seen, or has a pixel beside it that is.
// An invocation for each group of the blocks of 8 x 8 pixels that the pieces may cover, x | y << 16 in
// blocks (server/gpu/pieces.h).

layout(local_size_x = 64) in;

layout(std430, binding = 2) readonly buffer Blocks {
    uint blocks[];
};

layout(binding = 0) uniform sampler2D seen_depth;

uniform uint n_blocks;

bool is_seen(ivec2 p)
{
    return texelFetch(seen_depth, clamp(p, ivec2(0), tile.zw - 1), 0).x > 0.0;
}

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    uint block = blocks[min(i / 8u, n_blocks - 1u)];
    ivec2 group = list_place(block) * ivec2(2, 4) + ivec2(i % 2u, i / 2u % 4u);
    ivec2 first = group * ivec2(4, 2);
    bool any_seen = false;
    for (int y = -1; y <= 2; y++)
        for (int x = y == -1 || y == 2 ? 0 : -1; x <= (y == -1 || y == 2 ? 3 : 4); x++)
            any_seen = any_seen || is_seen(first + ivec2(x, y));
    if (i / 8u >= n_blocks || !any_seen || any(greaterThanEqual(first, tile.zw)))
        return;
    LIST_ADD(groups, group, 8u)
}
