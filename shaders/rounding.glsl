// The rounding of a semi-sharp crease that is narrower than a pixel: too narrow for rays, yet its normals turn from
// one side's normal to the other's and may show most of the light.
//
// Across a crease of sharpness s the surface is a cubic B-spline whose control polygon is straight on both sides. A
// width is 2^-s of the face. At a distance of t widths from the crease the tangent is (1 - w) b + w a with w = (1 -
// t)^2 / 2, where b is this side's tangent and a the other side's. Normals turn in the same way.

const int ROUNDING_PARTS = 3;

// Share of the pixel that the rounding takes, on the piece's own side.
float rounding_share(Piece piece)
{
    vec2 g = piece.crease.across;
    return half_plane(piece.crease.reach, g) - half_plane(piece.crease.reach - piece.rounding, g);
}

vec3 rounding_normal(vec3 side, vec3 other, float t)
{
    return normalize(mix(side, other, 0.5 * (1.0 - t) * (1.0 - t)));
}

vec2 rounding_place(Piece piece)
{
    return clamp(piece.crease.across * (piece.crease.reach - 0.5 * piece.rounding), -0.5, 0.5);
}

// A part of the pixel along the crease, to be averaged over all directions of its normal.
struct Strip {
    mat2 sides;  // px
    vec3 n;
    vec3 turn;   // how the normal turns across the strip
};

Strip rounding_strip(Piece piece, vec3 side, vec3 other, int i)
{
    vec2 g = piece.crease.across;
    vec3 inner = rounding_normal(side, other, float(i) / float(ROUNDING_PARTS));
    vec3 outer = rounding_normal(side, other, float(i + 1) / float(ROUNDING_PARTS));
    mat2 sides = mat2(g * (piece.rounding / float(ROUNDING_PARTS)), vec2(-g.y, g.x));
    return Strip(sides, normalize(inner + outer), inner - outer);
}
