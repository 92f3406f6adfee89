// Sorts the pixels at edges into two lists. Pixels to recheck join the list of rounded pixels, so that rays meet the
// surface itself there. All others are shaded from the pieces of surface around them.
//
// A pixel must be rechecked in any of these cases. A piece contradicts what the centre of a pixel around shows by
// more than OFF: it covers a centre that does not show it, or ends before a centre that does. Three pieces are
// around, or two pieces and a pixel that shows nothing: a piece knows only its own ends, and anything may lie between
// these. Beside a pixel that shows nothing, not exactly one end of the only piece runs through the pixel: with two, the
// piece may turn where they meet; with none, something that no centre around shows may lie there. Beside a pixel that
// shows nothing, the piece ends at a crease whose other side faces the eye too: that side may be visible, though
// narrower than a pixel. Pixels beyond the picture may show nothing; but a piece without an end fills its pixel there.

layout(local_size_x = 32) in;  // EDGES_PER_GROUP

LIST(2, Edges, edges);
LIST(3, Rounded, rounded);

const float OFF = 0.07, CREASE_NEAR = 0.7;  // px

// The pixel itself comes first.
const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1), ivec2(-1, -1),
                                 ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

bool disagrees(Piece piece, vec2 place, Hit there)
{
    float inside = inside_px(piece, place);
    if (there.depth > 0.0 && same_surface(piece.hit, there))
        return inside < -OFF;
    float z = depth_at(piece, place);
    return inside > OFF && z > 0.0 && (there.depth == 0.0 || there.depth > z + pixel_units(z));
}

// Number of the piece's ends that run through the pixel.
int ends_in_pixel(Piece piece)
{
    int n = 0;
    for (int k = 0; k < ENDS; k++) {
        End end = piece.end[k];
        n += int(k < piece.n_ends && abs(end.reach) < 0.5 * (abs(end.across.x) + abs(end.across.y)));
    }
    return n;
}

// Whether the pixel at `at` knows a crease that lies within pixel p and whose other side faces the eye.
bool is_crease_seen_beyond(ivec2 p, ivec2 at)
{
    uint crease = texelFetch(ends, p + at, 0).y;
    vec2 place = vec2(at) + end_off(crease) * end_across(crease);
    return crease != NO_END && (crease & END_GOES_ON) != 0u && max(abs(place.x), abs(place.y)) < CREASE_NEAR;
}

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 32u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    Piece piece[2];
    int n = 0;
    bool beside_empty = false, beside_unknown = false, seen_beyond = false;
    for (int k = 0; k < 9 && n < 3; k++) {
        Hit hit = hit_at(p + AROUND[k]);
        beside_empty = beside_empty || hit.depth == 0.0;
        beside_unknown = beside_unknown || hit.depth < 0.0;  // beyond the picture
        if (!mirrors(hit))
            continue;
        seen_beyond = seen_beyond || is_crease_seen_beyond(p, AROUND[k]);
        if (n > 0 && same_surface(piece[0].hit, hit))
            add_ends(piece[0], p, AROUND[k]);
        else if (n > 1 && same_surface(piece[1].hit, hit))
            add_ends(piece[1], p, AROUND[k]);
        else {
            if (n == 0)
                piece[0] = piece_of(hit, p, AROUND[k]);
            else if (n == 1)
                piece[1] = piece_of(hit, p, AROUND[k]);
            n++;
        }
    }
    int ends = n == 1 ? ends_in_pixel(piece[0]) : 0;
    bool is_unclear = n > 1 || seen_beyond || ends > 1, is_hidden = n == 1 && ends == 0;
    bool needs_recheck = n > 2 || ((beside_empty || beside_unknown) && is_unclear) || (beside_empty && is_hidden);
    for (int k = 0; k < 9 && !needs_recheck; k++) {
        Hit hit = hit_at(p + AROUND[k]);
        if (hit.depth >= 0.0)
            needs_recheck = (n > 0 && disagrees(piece[0], vec2(AROUND[k]), hit)) ||
                            (n > 1 && disagrees(piece[1], vec2(AROUND[k]), hit));
    }
    if (needs_recheck)
        LIST_ADD(rounded, p + ivec2(0, AT_EDGE), ROUNDED_PER_GROUP)
    else
        LIST_ADD(edges, p, EDGES_PER_GROUP)
}
