// Lists the pixels at edges, those that turn, and those that show the rounding of a crease, and writes
// the coverage of all others. At an edge is a pixel whose border runs through it, whose neighbour to a side is not
// where its paraboloid says, one beside or across a corner from which shows surface where it shows none, or none
// where it does, and one at the rim that shows surface. Those of them that show surface are listed apart, and around what is shaded too, since the pixels
// there ask where these end (ends_find.comp.glsl).

layout(local_size_x = 64) in;

layout(binding = 5, r32f) writeonly uniform image2D coverage;

LIST(0, Edges, edges);
LIST(2, HighCurvature, high_curvature);
LIST(3, Rounded, rounded);
LIST(4, Rims, rims);

uniform ivec4 shaded;  // x, y, width, height: the part of what is drawn that the lists are for

layout(binding = 6, rg32ui) writeonly uniform uimage2D ends;

const ivec2 AROUND[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
const ivec2 DIAGONAL[4] = ivec2[4](ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

bool border_crosses(ivec2 p)
{
    vec2 foot = border_foot(imageLoad(border, p).x);
    return dot(foot, foot) <= 0.5 * (abs(foot.x) + abs(foot.y));
}

// How far the normal turns from side to side, rad.
const float MOST_TURN = 0.025;

float turn_over_pixel(ivec2 p, Hit hit)
{
    vec3 e1, e2;
    tangent_basis(hit.n, e1, e2);
    vec3 d = to_world(vec3(pixel_offset(p) * ray.x, 1.0));
    mat2 h = mat2(hit.h.xy, hit.h.yz);
    float turn = 0.0;
    for (int i = 0; i < 2; i++) {
        vec3 along = axis[i].xyz - d * (dot(axis[i].xyz, hit.n) / dot(d, hit.n));
        turn = max(turn, length(h * vec2(dot(along, e1), dot(along, e2))));
    }
    return turn * pixel_units(hit.depth);
}

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    Hit own = hit_at(p);
    bool at_rim = any(lessThan(p, ivec2(1))) || any(greaterThan(p, tile.zw - 2));
    bool is_hit = own.depth > 0.0, at_edge = is_hit && (at_rim || border_crosses(p));
    bool is_rounded = is_hit && imageLoad(border, p).x == ROUNDED, beside_rounded = false;
    for (int i = 0; i < 4; i++) {
        ivec2 q = clamp(p + AROUND[i], ivec2(0), tile.zw - 1);
        float z = imageLoad(hit_depth, q).x;
        beside_rounded = beside_rounded || (z > 0.0 && imageLoad(border, q).x == ROUNDED);
        bool is_off = off_paraboloid(own, on_ray(pixel_offset(q), z)) > SAME_PX;
        at_edge = at_edge || is_hit != z > 0.0 || (is_hit && is_off);
    }
    for (int i = 0; i < 4; i++) {
        ivec2 q = clamp(p + DIAGONAL[i], ivec2(0), tile.zw - 1);
        at_edge = at_edge || is_hit != imageLoad(hit_depth, q).x > 0.0;
    }
    imageStore(ends, p, uvec4(NO_END, end_of_border(imageLoad(border, p).x), 0u, 0u));
    if (is_hit && at_edge)
        LIST_ADD(rims, p, 64u)
    if (any(lessThan(p, shaded.xy)) || any(greaterThanEqual(p, shaded.xy + shaded.zw)))
        return;
    imageStore(coverage, p, vec4(is_hit));
    if (is_rounded || (at_edge && beside_rounded))
        LIST_ADD(rounded, p + ivec2(0, at_edge ? AT_EDGE : 0), ROUNDED_PER_GROUP)
    else if (at_edge)
        LIST_ADD(edges, p, EDGES_PER_GROUP)
    else if (is_hit && turn_over_pixel(p, own) > MOST_TURN)
        LIST_ADD(high_curvature, p, 64u)
}
