// Geometric antialiasing: what the passes share that shade pixels crossed by silhouettes, creases and open borders.
//
// Around each pixel's hit the surface is known to second order: a paraboloid from position, normal and shape
// operator. The plane `ends` says where the piece of surface that a pixel shows ends. The passes, in order:
//
// edges_find lists the pixels at edges, that is those whose neighbours do not lie on their paraboloid. ends_find finds
// where the pieces end that pixels at edges show. edges_recheck finds the pixels at edges where the pieces around contradict
// each other. edges_shade shades each of the other pixels at edges from the pieces around, by the share of each.
// high_curvature_shade shades in nine parts the pixels without an edge for which one footprint is not enough
// (uneven.glsl). Pixels to recheck, and pixels that show the
// rounding of a crease between half a pixel and some pixels wide, meet the surface again by rays: rounded.glsl.
//
// At the rim of a picture the pixels beyond are unknown: a pixel there that shows surface counts as at an edge, and
// what lies beyond its ends counts as empty unless the surface goes on there (edges_recheck.comp.glsl).

layout(binding = 4, r32ui) readonly uniform uimage2D border;

const uint EDGES_PER_GROUP = 32u;  // pixels

// Distance of x from the paraboloid at `a`, px.
float off_paraboloid(Hit a, vec3 x)
{
    vec3 e1, e2, d = x - a.x;
    tangent_basis(a.n, e1, e2);
    vec2 t = vec2(dot(d, e1), dot(d, e2));
    float rise = 0.5 * dot(t, mat2(a.h.xy, a.h.yz) * t);
    return abs(dot(d, a.n) - rise) / pixel_units(a.depth);
}

const float SAME_PX = 0.25;  // two hits that are no farther apart are of one surface

// The paraboloid's normal at the offset `move` from the hit.
vec3 normal_at(Hit a, vec3 move)
{
    vec3 e1, e2;
    tangent_basis(a.n, e1, e2);
    vec2 turn = mat2(a.h.xy, a.h.yz) * vec2(dot(move, e1), dot(move, e2));
    return normalize(a.n - e1 * turn.x - e2 * turn.y);
}

bool border_crosses(ivec2 p)
{
    vec2 foot = border_foot(imageLoad(border, p).x);
    return dot(foot, foot) <= 0.5 * (abs(foot.x) + abs(foot.y));
}

const ivec2 BESIDE[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
const ivec2 DIAGONAL[4] = ivec2[4](ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

// Whether pixel p, whose hit is `own`, is at an edge: its nearest border runs through it; or a neighbour to a side
// does not lie on its paraboloid; or of the pixel and one of its eight neighbours only one shows surface; or it shows
// surface at the rim of what is drawn.
bool is_at_edge(ivec2 p, Hit own)
{
    bool at_rim = any(lessThan(p, ivec2(1))) || any(greaterThan(p, tile.zw - 2));
    bool is_hit = own.depth > 0.0, at_edge = is_hit && (at_rim || border_crosses(p));
    for (int i = 0; i < 4; i++) {
        ivec2 q = clamp(p + BESIDE[i], ivec2(0), tile.zw - 1);
        float z = imageLoad(hit_depth, q).x;
        bool is_off = off_paraboloid(own, on_ray(pixel_offset(q), z)) > SAME_PX;
        at_edge = at_edge || is_hit != z > 0.0 || (is_hit && is_off);
    }
    for (int i = 0; i < 4; i++) {
        ivec2 q = clamp(p + DIAGONAL[i], ivec2(0), tile.zw - 1);
        at_edge = at_edge || is_hit != imageLoad(hit_depth, q).x > 0.0;
    }
    return at_edge;
}

// A pixel of high curvature is one across which the normal turns by more than this, rad.
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

bool same_surface(Hit a, Hit b)
{
    return off_paraboloid(a, b.x) < SAME_PX && dot(a.n, b.n) > 0.9;
}
