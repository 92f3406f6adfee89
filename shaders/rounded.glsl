// Rays for the pixels that one footprint or one paraboloid does not describe: those that show the rounding of a
// semi-sharp crease between half a pixel and some pixels wide, and those that edges_recheck.comp.glsl lists.
//
// Rays spread over the pixel meet the limit surface itself (rounded_solve), and each is shaded with the footprint of
// its own part of the pixel (rounded_shade). There is memory for 16 rays each in max_rounded pixels. If more pixels
// are listed, every pixel gets fewer rays, so that no pixel's result depends on the order of the list.

const uint MAX_RAYS = 16u;
const uint ROUNDED_PER_GROUP = 64u / MAX_RAYS;

uniform uint max_rounded;

// A pixel has side x side rays. If side is 0, as when half of the picture is listed, the pixel keeps the colour it
// has.
int rounded_side(uint n_listed)
{
    return n_listed <= max_rounded ? 4 : n_listed <= 4u * max_rounded ? 2
                                     : n_listed <= 16u * max_rounded ? 1 : 0;
}

// Added to the y of a listed pixel if an edge runs through it.
const int AT_EDGE = 0x8000;

ivec2 rounded_pixel(uint listed_pixel)
{
    return list_place(listed_pixel) & (AT_EDGE - 1);
}

bool rounded_at_edge(uint listed_pixel)
{
    return listed_pixel >> 31 != 0u;
}

// Places of the 16 rays of a pixel at an edge, px from its centre. There is one in each of 4 x 4 squares, moved
// within its square by search so that for any straight line the share of rays on one side is within 0.09 of the
// pixel's share there. (With rays in the squares' middles that would be up to 0.125.) Pixels without an edge use the
// middles, which give the mean better.
const vec2 EDGE_RAYS[16] = vec2[16](
    vec2(-0.278, -0.409), vec2(0.000, -0.376), vec2(0.248, -0.406), vec2(0.426, -0.256),
    vec2(-0.429, -0.205), vec2(-0.171, -0.145), vec2(0.096, -0.143), vec2(0.318, -0.023),
    vec2(-0.417, 0.092), vec2(-0.141, 0.061), vec2(0.114, 0.113), vec2(0.402, 0.222),
    vec2(-0.348, 0.322), vec2(-0.189, 0.404), vec2(0.070, 0.342), vec2(0.306, 0.414));

// Offset of ray i from its pixel's centre, px.
vec2 rounded_place(int i, int side, bool at_edge)
{
    return side == 4 && at_edge ? EDGE_RAYS[i] : (vec2(i % side, i / side) + 0.5) / float(side) - 0.5;
}

struct RoundedHit {
    vec4 normal_depth;  // world axes; depth 0: the ray meets nothing
    vec4 shape;         // in tangent_basis(normal); w unused
};
