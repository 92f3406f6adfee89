// Lists the pixels at edges and the pixels that show the rounding of a crease; writes
// the coverage of all others. A further list has the pixels at edges that show surface, for ends_find.comp.glsl; it
// also has those just outside `shaded`, since the pixels inside ask where these end.

layout(local_size_x = 64) in;

layout(binding = 5, r32f) writeonly uniform image2D coverage;

LIST(0, Edges, edges);
LIST(3, Rounded, rounded);
LIST(4, Rims, rims);

uniform ivec4 shaded;  // x, y, width, height: the part of what is drawn that the lists are for

layout(binding = 6, rg32ui) writeonly uniform uimage2D ends;

// The first order is trusted for borders up to this distance. Farther borders count only where they are found on the
// surface itself.
const float FIRST_ORDER_PX = 1.0;

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    Hit own = hit_at(p);
    bool is_hit = own.depth > 0.0, at_edge = is_at_edge(p, own);
    bool is_rounded = is_hit && imageLoad(border, p).x == ROUNDED, beside_rounded = false;
    for (int i = 0; i < 4; i++) {
        ivec2 q = clamp(p + BESIDE[i], ivec2(0), tile.zw - 1);
        bool is_there = imageLoad(hit_depth, q).x > 0.0;
        beside_rounded = beside_rounded || (is_there && imageLoad(border, q).x == ROUNDED);
    }
    uint to_border = end_of_border(imageLoad(border, p).x);
    bool is_known = (is_hit && at_edge) || end_off(to_border) < FIRST_ORDER_PX;
    imageStore(ends, p, uvec4(NO_END, is_known ? to_border : NO_END, 0u, 0u));
    if (is_hit && at_edge)
        LIST_ADD(rims, p, 64u)
    if (any(lessThan(p, shaded.xy)) || any(greaterThanEqual(p, shaded.xy + shaded.zw)))
        return;
    imageStore(coverage, p, vec4(is_hit));
    if (is_rounded || (at_edge && beside_rounded))
        LIST_ADD(rounded, p + ivec2(0, at_edge ? AT_EDGE : 0), ROUNDED_PER_GROUP)
    else if (at_edge)
        LIST_ADD(edges, p, EDGES_PER_GROUP)
}
