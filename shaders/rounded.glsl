// Pixels that show the rounding of a semi-sharp crease, from half a pixel to some pixels wide, and those that
// edges_recheck.comp.glsl lists to be rechecked: one footprint or one paraboloid does not tell what they show. Rays
// spread over the pixel meet the limit surface itself (rounded_solve), and each is shaded with the footprint of its own
// part of the pixel (rounded_shade).
//
// There is memory for 16 rays of max_rounded pixels. Where more are listed each has fewer, so that what
// a pixel shows does not depend on the order in which they were.

const uint MAX_RAYS = 16u;
const uint ROUNDED_PER_GROUP = 64u / MAX_RAYS;

uniform uint max_rounded;

// A pixel has side x side rays; where that is 0, as when half of the picture is listed, it keeps the
// colour it has.
int rounded_side(uint n_listed)
{
    return n_listed <= max_rounded ? 4 : n_listed <= 4u * max_rounded ? 2
                                     : n_listed <= 16u * max_rounded ? 1 : 0;
}

// Added to the y of a listed pixel that an edge runs through.
const int AT_EDGE = 0x8000;

ivec2 rounded_pixel(uint listed_pixel)
{
    return list_place(listed_pixel) & (AT_EDGE - 1);
}

bool rounded_at_edge(uint listed_pixel)
{
    return listed_pixel >> 31 != 0u;
}

// The places of 16 rays of a pixel at an edge, px from its centre: one in each of 4 x 4 squares, moved within these by
// search so that the share of them on one side of a straight line, whichever it is, is within 0.09 of the pixel's share
// there. (In the middles of the squares they would be up to 0.125 off.) Elsewhere the middles tell the mean better.
const vec2 EDGE_RAYS[16] = vec2[16](
    vec2(-0.278, -0.409), vec2(0.000, -0.376), vec2(0.248, -0.406), vec2(0.426, -0.256),
    vec2(-0.429, -0.205), vec2(-0.171, -0.145), vec2(0.096, -0.143), vec2(0.318, -0.023),
    vec2(-0.417, 0.092), vec2(-0.141, 0.061), vec2(0.114, 0.113), vec2(0.402, 0.222),
    vec2(-0.348, 0.322), vec2(-0.189, 0.404), vec2(0.070, 0.342), vec2(0.306, 0.414));

// Where ray i leaves its pixel's centre, px.
vec2 rounded_place(int i, int side, bool at_edge)
{
    return side == 4 && at_edge ? EDGE_RAYS[i] : (vec2(i % side, i / side) + 0.5) / float(side) - 0.5;
}

struct RoundedHit {
    vec4 normal_depth;  // world; depth 0: nothing is met
    vec4 shape;         // in tangent_basis(normal); w unused
};
