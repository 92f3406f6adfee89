// Runs after stage 1. First list: the groups of 4 x 2 pixels in which a pixel shows surface, or lies beside one that
// does. Second list: those of these groups that are not calm (seen.glsl), because depths are discontinuous there.
//
// One invocation for each group of the blocks of 8 x 8 pixels that the grids may cover; a block is given as x | y <<
// 16 in blocks (server/render/patch_grids.h).

layout(local_size_x = 64) in;

layout(std430, binding = 2) readonly buffer Blocks {
    uint blocks[];
};

LIST(3, Discontinuous, discontinuous);

uniform uint n_blocks;

const int WIDTH = 4, HEIGHT = 2;

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    uint block = blocks[min(i / 8u, n_blocks - 1u)];
    ivec2 group = list_place(block) * ivec2(2, 4) + ivec2(i % 2u, i / 2u % 4u);
    ivec2 first = group * ivec2(WIDTH, HEIGHT);
    // Depths of the group and of the pixels around it; the group's first pixel is at [1][1].
    float ndc[HEIGHT + 2][WIDTH + 2];
    for (int y = 0; y < HEIGHT + 2; y++)
        for (int x = 0; x < WIDTH + 2; x++)
            ndc[y][x] = ndc_at(first + ivec2(x, y) - 1);
    bool any_seen = false, calm = true;
    for (int y = 1; y <= HEIGHT; y++) {
        for (int x = 1; x <= WIDTH; x++) {
            float own = ndc[y][x];
            float front = max(max(ndc[y][x - 1], ndc[y][x + 1]), max(ndc[y - 1][x], ndc[y + 1][x]));
            float z = depth_of(own);
            any_seen = any_seen || max(own, front) > 0.0;
            calm = calm && (own > 0.0 ? front_of(front) >= z - CALM * pixel_units(z) : front == 0.0);
        }
    }
    if (i / 8u >= n_blocks || !any_seen || any(greaterThanEqual(first, tile.zw)))
        return;
    LIST_ADD(groups, group, 8u)
    if (!calm)
        LIST_ADD(discontinuous, group, 8u)
}
