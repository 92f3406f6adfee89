// Sorts the pixels at edges into two lists. A pixel must be rechecked where a piece of surface around it contradicts
// what a pixel's centre shows: the piece reaches a centre that does not show it, or ends before a centre that does, by
// more than OFF. A pixel must also be rechecked where three pieces are around it, or two pieces and a pixel that shows
// nothing: each piece tells its own end only, and between the ends there may be anything. Pixels to recheck join the
// list of rounded ones, so that rays meet the surface itself there; all others are shaded from the pieces.

layout(local_size_x = 32) in;  // EDGES_PER_GROUP

LIST(2, Edges, edges);
LIST(3, Rounded, rounded);

const float OFF = 0.1;  // px

const ivec2 AROUND[8] = ivec2[8](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1), ivec2(-1, -1),
                                 ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

bool disagrees(Piece piece, vec2 place, Hit there)
{
    float inside = inside_px(piece, place);
    if (there.depth > 0.0 && same_surface(piece.hit, there))
        return inside < -OFF;
    float z = depth_at(piece, place);
    return inside > OFF && z > 0.0 && (there.depth == 0.0 || there.depth > z + pixel_units(z));
}

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 32u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    Hit own = hit_at(p);
    Piece piece;
    Hit first = own, second;
    second.depth = 0.0;
    if (mirrors(own))
        piece = piece_of(own, p, ivec2(0));
    bool needs_recheck = false, beside_empty = own.depth == 0.0;
    for (int k = 0; k < 8 && !needs_recheck; k++) {
        Hit hit = hit_at(p + AROUND[k]);
        beside_empty = beside_empty || hit.depth == 0.0;
        if (mirrors(own) && hit.depth >= 0.0)
            needs_recheck = disagrees(piece, vec2(AROUND[k]), hit);
        if (!mirrors(hit))
            continue;
        needs_recheck = needs_recheck || disagrees(piece_of(hit, p, AROUND[k]), vec2(0.0), own);
        if (!(first.depth > 0.0))
            first = hit;
        else if (!same_surface(first, hit)) {
            needs_recheck = needs_recheck || (second.depth > 0.0 && !same_surface(second, hit));
            second = hit;
        }
    }
    if (needs_recheck || (beside_empty && second.depth > 0.0))
        LIST_ADD(rounded, p, ROUNDED_PER_GROUP)
    else
        LIST_ADD(edges, p, EDGES_PER_GROUP)
}
