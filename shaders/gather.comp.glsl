// After stage 1: lists the groups of 4 x 2 pixels that show surface, or have a pixel beside them that does;
// and in a second list those of these groups whose depths are discontinuous: not calm (seen.glsl).
// An invocation for each group of the blocks of 8 x 8 pixels that the grids may cover, x | y << 16 in
// blocks (server/render/patch_grids.h).

layout(local_size_x = 64) in;

layout(std430, binding = 2) readonly buffer Blocks {
    uint blocks[];
};

LIST(3, Discontinuous, discontinuous);

uniform uint n_blocks;

const int WIDTH = 4, HEIGHT = 2;
const int ACROSS = WIDTH + 2, DOWN = HEIGHT + 2;  // with the pixels around

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    uint block = blocks[min(i / 8u, n_blocks - 1u)];
    ivec2 group = list_place(block) * ivec2(2, 4) + ivec2(i % 2u, i / 2u % 4u);
    ivec2 first = group * ivec2(WIDTH, HEIGHT);
    // Of the group and what is around it; row after row; its first pixel at (1, 1).
    float ndc[ACROSS * DOWN];
    for (int y = 0; y < DOWN; y++)
        for (int x = 0; x < ACROSS; x++)
            ndc[y * ACROSS + x] = ndc_at(first + ivec2(x, y) - 1);
    bool any_seen = false, calm = true;
    for (int y = 1; y <= HEIGHT; y++) {
        for (int x = 1; x <= WIDTH; x++) {
            int at = y * ACROSS + x;
            float own = ndc[at];
            float front = max(max(ndc[at - 1], ndc[at + 1]), max(ndc[at - ACROSS], ndc[at + ACROSS]));
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
