// Geometric antialiasing: the pixels that silhouettes, creases and open borders run through.
//
// Around each pixel's hit the surface is known to second order: a paraboloid from position, normal
// and shape operator. Where its own piece ends is known too: the plane `ends`.
//   edges_find            lists the pixels whose neighbours their own paraboloid does not explain, and apart
//                         from them those over which the normal turns so far that one footprint cannot tell;
//   ends_find             finds where the pieces that pixels at edges show end;
//   edges_recheck         sorts out the pixels at edges where the pieces around contradict each other;
//   edges_shade           for each of the others at edges, shades the share of each of the pieces around;
//   high_curvature_shade  for each of those of high curvature, shades nine parts of it.
// Pixels that show the rounding of a crease, half a pixel to some pixels wide, and those to recheck ask
// the surface again: rounded.glsl.
// At the rim of a picture the pixels beyond are not known: what is seen there counts as at an edge, and what of it is
// beyond its ends as empty, unless the surface goes on there (edges_recheck.comp.glsl).

layout(binding = 4, r32ui) readonly uniform uimage2D border;

const uint EDGES_PER_GROUP = 32u;  // pixels

// Whether the paraboloid at `a` runs through x: how far off, px.
float off_paraboloid(Hit a, vec3 x)
{
    vec3 e1, e2, d = x - a.x;
    tangent_basis(a.n, e1, e2);
    vec2 t = vec2(dot(d, e1), dot(d, e2));
    float rise = 0.5 * dot(t, mat2(a.h.xy, a.h.yz) * t);
    return abs(dot(d, a.n) - rise) / pixel_units(a.depth);
}

const float SAME_PX = 0.25;  // as far as that, two hits are of one surface

// The paraboloid's normal at `move` from the hit.
vec3 normal_at(Hit a, vec3 move)
{
    vec3 e1, e2;
    tangent_basis(a.n, e1, e2);
    vec2 turn = mat2(a.h.xy, a.h.yz) * vec2(dot(move, e1), dot(move, e2));
    return normalize(a.n - e1 * turn.x - e2 * turn.y);
}

bool same_surface(Hit a, Hit b)
{
    return off_paraboloid(a, b.x) < SAME_PX && dot(a.n, b.n) > 0.9;
}
