layout(binding = 3) uniform usampler2D silhouette;

// The pieces of surface that a pixel looked at more closely may show (edges.glsl): a paraboloid each,
// clipped by its border's line, and shaded away from the pixel it was seen at.

LIST(0, Listed, listed);  // the pixels to shade

// Along the ray through the place where it was met plus d px, z units beyond its depth, a piece is where
// a z^2 + b z + c = 0.
struct Piece {
    Hit hit;
    vec2 at;     // where it was met, px from the middle of the pixel looked at
    float a;
    vec3 b;      // b.x + dot(b.yz, d)
    vec2 c;      // dot(c, d) + dot(cc, (dx dx, dx dy, dy dy))
    vec3 cc;
    vec2 foot;   // where it ends: at the line across this, px
    float rounding;  // how wide it is rounded towards there, px
    float reach;     // dot(foot, d) where it ends
    vec2 rim;        // and at its silhouette
    float rim_reach;
    float lacking;   // of b b - 4 a c, where it does not reach as far as the paraboloid does
};

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
    uint packed_border = imageLoad(border, p + at).x;
    piece.foot = border_foot(packed_border);
    piece.reach = dot(piece.foot, piece.foot);
    piece.rim = border_foot(texelFetch(silhouette, p + at, 0).x);
    piece.rim_reach = dot(piece.rim, piece.rim);
    piece.lacking = 0.0;
    piece.rounding = border_rounding(packed_border);
    return piece;
}

// Depth at `place`, px from the middle of the pixel looked at, also beyond the piece's ends.
float depth_at(Piece piece, vec2 place)
{
    vec2 d = place - piece.at;
    float b = piece.b.x + dot(piece.b.yz, d);
    float c = dot(piece.c, d) + dot(piece.cc, vec3(d.x * d.x, d.x * d.y, d.y * d.y));
    // Of the two solutions the one that is 0 at d = 0.
    float root = sqrt(max(b * b - 4.0 * piece.a * c, 0.0));
    float below = b + (piece.b.x < 0.0 ? -root : root);
    return piece.hit.depth - 2.0 * c / (below == 0.0 ? 1e-30 : below);
}

// How far a place is inside the piece's silhouette: a function that is next to linear, with its gradient.
float inside_silhouette(Piece piece, vec2 place, out vec2 gradient)
{
    vec2 d = place - piece.at;
    float to_rim = dot(piece.rim, d);
    if (piece.rim != NO_BORDER && to_rim > 0.0) {
        gradient = -piece.rim;
        return piece.rim_reach - to_rim;
    }
    float b = piece.b.x + dot(piece.b.yz, d);
    float c = dot(piece.c, d) + dot(piece.cc, vec3(d.x * d.x, d.x * d.y, d.y * d.y));
    vec2 dc = piece.c + vec2(2.0 * piece.cc.x * d.x + piece.cc.y * d.y,
                             piece.cc.y * d.x + 2.0 * piece.cc.z * d.y);
    gradient = 2.0 * b * piece.b.yz - 4.0 * piece.a * dc;
    return b * b - 4.0 * piece.a * c - piece.lacking;
}

// How much of a square the piece covers.
float piece_share(Piece piece, vec2 middle, float size)
{
    vec2 gradient;
    float inside = inside_silhouette(piece, middle, gradient);
    float to_border = piece.reach - dot(piece.foot, middle - piece.at);
    return half_plane(inside, size * gradient) * half_plane(to_border, size * piece.foot);
}

bool covers(Piece piece, vec2 place)
{
    vec2 gradient;
    return inside_silhouette(piece, place, gradient) >= 0.0 && dot(piece.foot, place - piece.at) <= piece.reach &&
           depth_at(piece, place) > 0.0;
}

// How far inside the piece's ends a place is, px: less than 0 outside.
float inside_px(Piece piece, vec2 place)
{
    vec2 gradient;
    float inside = inside_silhouette(piece, place, gradient);
    float to_border = piece.reach - dot(piece.foot, place - piece.at);
    return min(inside / max(length(gradient), 1e-30), to_border / max(length(piece.foot), 1e-30));
}

// Where a piece reaches a place that it does not show, its silhouette or its border is a little off: moves
// the nearer of both to there. False where that is too far away.
const float MOST_OFF = 0.5;  // px

bool end_at(inout Piece piece, vec2 place)
{
    vec2 gradient;
    float inside = inside_silhouette(piece, place, gradient), far = length(gradient);
    float to_border = piece.reach - dot(piece.foot, place - piece.at);
    float off_silhouette = inside / max(far, 1e-30), off_border = to_border / length(piece.foot);
    if (min(inside, to_border) <= 0.0)
        return true;
    if (min(off_silhouette, off_border) > MOST_OFF)
        return false;
    if (off_border < off_silhouette)
        piece.reach -= to_border;
    else if (gradient == -piece.rim)
        piece.rim_reach -= inside;
    else
        piece.lacking += inside;
    return true;
}

const float NOWHERE = 1e30;  // a depth that nothing has
