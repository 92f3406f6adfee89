// The pieces of surface that a pixel looked at more closely may show (edges.glsl): a paraboloid each,
// clipped by its border's line, and shaded away from the pixel it was seen at.

LIST(0, Listed, listed);  // the pixels to shade

// Along the ray through its own pixel's centre plus d px, z units beyond its depth, a piece is where
// a z^2 + b z + c = 0.
struct Piece {
    Hit hit;
    vec2 at;     // its pixel, from the one looked at
    float a;
    vec3 b;      // b.x + dot(b.yz, d)
    vec2 c;      // dot(c, d) + dot(cc, (dx dx, dx dy, dy dy))
    vec3 cc;
    vec2 foot;   // where it ends: at the line across this, px
    float rounding;  // how wide it is rounded towards there, px
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
    piece.rounding = border_rounding(packed_border);
    return piece;
}

// Depth at `place`, px from the middle of the pixel looked at; huge where the piece is not.
const float NOWHERE = 1e30;

float depth_at(Piece piece, vec2 place)
{
    vec2 d = place - piece.at;
    float b = piece.b.x + dot(piece.b.yz, d);
    float c = dot(piece.c, d) + dot(piece.cc, vec3(d.x * d.x, d.x * d.y, d.y * d.y));
    float beyond = b * b - 4.0 * piece.a * c;
    // Of the two solutions the one that is 0 at d = 0.
    float root = sqrt(max(beyond, 0.0));
    float z = piece.hit.depth - 2.0 * c / (b + (piece.b.x < 0.0 ? -root : root));
    bool there = beyond >= 0.0 && z > 0.0 && dot(piece.foot, d) <= dot(piece.foot, piece.foot);
    return there ? z : NOWHERE;
}

// From a hit to depth z on the ray of q, which is d px from its own.
vec3 move_to(Hit hit, vec2 d, vec2 q, float z)
{
    vec3 across = (axis[0].xyz * d.x + axis[1].xyz * d.y) * pixel_units(hit.depth);
    return across + to_world(vec3(q * ray.x, 1.0)) * (z - hit.depth);
}

// d: from the hit's own pixel, px; size: of its square.
Shown shade_ray(Hit hit, vec2 q, vec2 d, float size, float z, Shown behind)
{
    vec3 move = move_to(hit, d, q, z);
    Sample at = sample_at(q, size, z, normal_at(hit, move), hit.h, hit.n);
    return lay_over(behind, at, meet(at), q);
}
