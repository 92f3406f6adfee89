// The rounding of a semi-sharp crease that is narrower than a pixel: too narrow for rays, but its normals
// turn from one side's to the other's and may show most of the light.
//
// Across a crease of sharpness s the surface is a cubic B-spline whose control polygon is straight on
// both sides, so at a distance of t widths from the crease (a width is 2^-s of the face) its tangent is
// (1 - w) b + w a with w = (1 - t)^2 / 2, b this side's and a the other's; normals turn alike.

const int ROUNDING_PARTS = 3;

// How much of the pixel the rounding takes, on the piece's own side.
float rounding_share(Piece piece)
{
    vec2 g = normalize(piece.foot);
    float off = dot(g, piece.at + piece.foot);
    return half_plane(off, g) - half_plane(off - piece.rounding, g);
}

vec3 rounding_normal(vec3 side, vec3 other, float t)
{
    return normalize(mix(side, other, 0.5 * (1.0 - t) * (1.0 - t)));
}

// Parts that lie along the crease, each averaged over all that its normal turns.
Shown shade_rounding(Piece piece, vec3 other, ivec2 p, Shown behind)
{
    vec2 g = normalize(piece.foot);
    float part = piece.rounding / float(ROUNDING_PARTS);
    vec2 place = clamp(g * (dot(g, piece.at + piece.foot) - 0.5 * piece.rounding), -0.5, 0.5);
    vec2 q = pixel_offset(p) + place;
    Hit hit = piece.hit;
    float z = depth_at(piece, place);
    vec3 move = move_to(hit, place - piece.at, q, z);
    vec3 side = normal_at(hit, move);
    Shown sum = Shown(vec4(0.0), 0.0);
    for (int i = 0; i < ROUNDING_PARTS; i++) {
        vec3 inner = rounding_normal(side, other, float(i) / float(ROUNDING_PARTS));
        vec3 outer = rounding_normal(side, other, float(i + 1) / float(ROUNDING_PARTS));
        Sample at = sample_over(q, mat2(g * part, vec2(-g.y, g.x)), z, normalize(inner + outer),
                                hit.h, hit.n);
        at.dn[0] = inner - outer;
        sum = added(sum, lay_over(behind, at, meet(at), q));
    }
    return scaled(sum, 1.0 / float(ROUNDING_PARTS));
}
