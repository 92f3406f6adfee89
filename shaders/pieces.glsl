layout(binding = 3) uniform usampler2D ends;

// The pieces of surface that may show in a pixel at an edge (edges.glsl). Each is a paraboloid made from the hit of a
// pixel around, clipped by the lines where the piece ends.

LIST(0, Listed, listed);  // the pixels to shade

// A line where a piece ends: the piece lies where dot(across, place) < reach, in px from the middle of the pixel
// looked at.
struct End {
    vec2 across;  // unit, outwards
    float reach;
    vec2 place;   // the place on the surface for which the line was found
};

// Each pixel that shows a piece knows the nearest places of its ends, so several pixels may know the same end; then
// the line found nearest to the pixel looked at counts. Two lines are of the same end if one passes the other's place
// by less than ALIKE_PX and the cosine of the angle between them is above ALIKE_COS.
const int ENDS = 3;
const float ALIKE_PX = 0.35, ALIKE_COS = 0.8;

// On the ray that passes d px from the place where the piece was met, the piece lies z units beyond that place's
// depth, where a z^2 + b z + c = 0.
struct Piece {
    Hit hit;
    vec2 at;     // where the piece was met, px from the middle of the pixel looked at
    float a;
    vec3 b;      // b.x + dot(b.yz, d)
    vec2 c;      // dot(c, d) + dot(cc, (dx dx, dx dy, dy dy))
    vec3 cc;
    End end[ENDS];   // where it ends
    int n_ends;
    End crease;      // the nearest border, as the pixel at `at` knows it
    float rounding;  // width of its rounding towards that border, px
    bool is_hidden;  // nothing of the piece shows in the pixel
};

bool is_alike(End other, End found)
{
    return dot(other.across, found.across) > ALIKE_COS && abs(dot(other.across, found.place) - other.reach) < ALIKE_PX;
}

// No store at a computed index: some devices then keep the array in memory.
void add_end(inout Piece piece, End found)
{
    bool is_new = true;
    for (int k = 0; k < ENDS; k++) {
        End other = piece.end[k];
        bool is_known = k < piece.n_ends && is_alike(other, found);
        if (is_known && dot(found.place, found.place) < dot(other.place, other.place))
            piece.end[k] = found;
        is_new = is_new && !is_known;
    }
    for (int k = 0; k < ENDS; k++)
        if (is_new && k == piece.n_ends)
            piece.end[k] = found;
    piece.n_ends += int(is_new && piece.n_ends < ENDS);
}

End end_from(uint packed_end, vec2 at)
{
    vec2 across = end_across(packed_end), place = at + end_off(packed_end) * across;
    return End(across, dot(across, place), place);
}

// Whether the pixel's centre lies in the rounding of a crease; there the paraboloid holds for less than a pixel.
bool is_in_rounding(ivec2 p)
{
    uint packed_end = texelFetch(ends, p, 0).y;
    return packed_end != NO_END && end_off(packed_end) == 0.0;
}

// Adds the ends that the pixel at `at` knows, which shows the same piece. Where its silhouette lies along a border,
// the nearer of the two ends the piece.
void add_ends(inout Piece piece, ivec2 p, ivec2 at)
{
    uvec2 packed_ends = texelFetch(ends, p + at, 0).xy;
    bvec2 is_end = bvec2(packed_ends.x != NO_END && end_off(packed_ends.x) > 0.0,
                         packed_ends.y != NO_END && end_off(packed_ends.y) > 0.0);
    End silhouette = end_from(packed_ends.x, vec2(at)), to_border = end_from(packed_ends.y, vec2(at));
    if (is_end.x && is_end.y && is_alike(silhouette, to_border)) {
        bool is_border = to_border.reach < silhouette.reach;
        is_end = bvec2(!is_border, is_border);
    }
    if (is_end.x)
        add_end(piece, silhouette);
    if (is_end.y)
        add_end(piece, to_border);
}

Piece piece_of(Hit hit, ivec2 p, ivec2 at)
{
    vec3 e1, e2;
    tangent_basis(hit.n, e1, e2);
    float px = pixel_units(hit.depth);
    vec3 right = axis[0].xyz, down = axis[1].xyz;
    vec3 ahead = to_world(vec3(pixel_offset(p + at) * ray.x, 1.0));
    vec2 r = vec2(dot(e1, right), dot(e2, right)), s = vec2(dot(e1, down), dot(e2, down));
    vec2 t = vec2(dot(e1, ahead), dot(e2, ahead));
    mat2 h = mat2(hit.h.xy, hit.h.yz);
    vec2 facing = vec2(dot(hit.n, right), dot(hit.n, down));
    Piece piece;
    piece.hit = hit;
    piece.at = vec2(at);
    piece.a = -0.5 * dot(t, h * t);
    piece.b = vec3(dot(hit.n, ahead), ray.x * facing - px * vec2(dot(r, h * t), dot(s, h * t)));
    piece.c = px * facing;
    piece.cc = -0.5 * px * px * vec3(dot(r, h * r), 2.0 * dot(r, h * s), dot(s, h * s));
    uint packed_crease = texelFetch(ends, p + at, 0).y;
    piece.crease = end_from(packed_crease, vec2(at));
    piece.rounding = packed_crease == NO_END ? 0.0 : end_rounding(packed_crease);
    piece.n_ends = 0;
    piece.is_hidden = false;
    add_ends(piece, p, at);
    return piece;
}

// Depth of the piece at `place`, px from the middle of the pixel looked at; also defined beyond the piece's ends.
float depth_at(Piece piece, vec2 place)
{
    vec2 d = place - piece.at;
    float b = piece.b.x + dot(piece.b.yz, d);
    float c = dot(piece.c, d) + dot(piece.cc, vec3(d.x * d.x, d.x * d.y, d.y * d.y));
    // Of the two solutions this one is 0 at d = 0.
    float root = sqrt(max(b * b - 4.0 * piece.a * c, 0.0));
    float below = b + (piece.b.x < 0.0 ? -root : root);
    return piece.hit.depth - 2.0 * c / (below == 0.0 ? 1e-30 : below);
}

// Share of a square that the piece covers.
float piece_share(Piece piece, vec2 middle, float size)
{
    float share = 1.0;
    for (int k = 0; k < ENDS; k++) {
        End end = piece.end[k];
        share *= k < piece.n_ends ? half_plane(end.reach - dot(end.across, middle), size * end.across) : 1.0;
    }
    return share;
}

const float FAR_INSIDE = 1e3;  // px

// Distance of a place from the piece's ends, px: positive inside, negative outside.
float inside_px(Piece piece, vec2 place)
{
    float inside = FAR_INSIDE;
    for (int k = 0; k < ENDS; k++) {
        End end = piece.end[k];
        inside = k < piece.n_ends ? min(inside, end.reach - dot(end.across, place)) : inside;
    }
    return inside;
}

bool covers(Piece piece, vec2 place)
{
    return inside_px(piece, place) >= 0.0 && depth_at(piece, place) > 0.0;
}

// Makes the piece end before a place that it reaches although the pixel there does not show it: the end nearest to
// that place is a little off, and moves there. False if it would have to move farther than MOST_OFF.
const float MOST_OFF = 0.5;  // px

bool end_at(inout Piece piece, vec2 place)
{
    float inside = inside_px(piece, place);
    if (inside <= 0.0)
        return true;
    if (inside > MOST_OFF)
        return false;
    for (int k = 0; k < ENDS; k++)
        if (piece.end[k].reach - dot(piece.end[k].across, place) == inside)
            piece.end[k].reach -= inside;
    return true;
}

const float NOWHERE = 1e30;  // a depth that no surface has
