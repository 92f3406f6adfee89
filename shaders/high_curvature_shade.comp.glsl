// Shades the listed pixels: those without an edge for which one footprint is not enough (uneven.glsl). Nine squares of
// each pixel are shaded separately.
//
// How the shape operator changes within such a pixel counts as much as how it turns the normal, and the pixel's own
// paraboloid does not know that change. The pixels around know it: their normals and shape operators are the
// surface's own. Between them and this pixel the normal is taken as a cubic function of the place.

layout(local_size_x = 64) in;

const uint SIDE = 3u, SQUARES = SIDE * SIDE;
const float STEP = 1.0 / float(SIDE);  // px: the side of a square

// The squares to shade: all of them, or one of them for one light after another, the hindmost light first.
uniform uint first_square, end_square;

// With several lights: the sum of what the squares before this one show.
layout(binding = 5, rgba32f) uniform image2D square_sum;

// The square's middle, px from the pixel's centre.
vec2 square_middle(uint i)
{
    return (vec2(i % SIDE, i / SIDE) + 0.5) * STEP - 0.5;
}

// Along one axis of the picture: what remains of the normal's change per pixel beyond `slope`, and how the change
// across the axis, `cross_slope`, varies with it.
struct Turning {
    vec3 slope, square, cube;
    vec3 cross_slope, cross_change, cross_square;
};

vec3[2] turn_a_pixel(Hit hit, ivec2 p)
{
    return sample_at(pixel_offset(p), 1.0, hit.depth, hit.n, hit.h, hit.n).dn;
}

// axis: 0 is right, 1 is down. A neighbour that shows another surface is not used.
Turning turning_along(Hit hit, vec3 turn[2], ivec2 p, int axis)
{
    Turning t = Turning(turn[axis], vec3(0.0), vec3(0.0), turn[1 - axis], vec3(0.0), vec3(0.0));
    ivec2 step = ivec2(1 - axis, axis);
    vec3 odd = vec3(0.0), cross_even = vec3(0.0);
    float n = 0.0;
    for (int side = -1; side < 2; side += 2) {
        ivec2 q = p + side * step;
        Hit beside = hit_at(q);
        if (!mirrors(beside) || !same_surface(hit, beside))
            continue;
        vec3 off = beside.n - hit.n - float(side) * t.slope;
        vec3 cross_off = turn_a_pixel(beside, q)[1 - axis] - t.cross_slope;
        t.square += off;
        odd += float(side) * off;
        t.cross_change += float(side) * cross_off;
        cross_even += cross_off;
        n += 1.0;
    }
    t.square /= max(n, 1.0);
    t.cross_change /= max(n, 1.0);
    if (n > 1.0) {
        t.cube = 0.5 * odd;
        t.cross_square = 0.5 * cross_even;
    }
    return t;
}

float squares_covered(Piece piece)
{
    float n = 0.0;
    for (uint i = 0u; i < SQUARES; i++)
        n += covers(piece, square_middle(i)) ? 1.0 : 0.0;
    return n;
}

void main()
{
    uint index = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (index >= listed.n)
        return;
    ivec2 p = list_place(listed.at[index]);
    Hit hit = hit_at(p);
    vec3 turn[2] = turn_a_pixel(hit, p);
    Turning along = turning_along(hit, turn, p, 0), down = turning_along(hit, turn, p, 1);
    vec3 twist = 0.5 * (along.cross_change + down.cross_change);
    Piece piece = piece_of(hit, p, ivec2(0));
    Shown behind = shown_behind(p), sum = Shown(vec4(0.0), 0.0);
    float n = 0.0;
    for (uint i = first_square; i < end_square; i++) {
        vec2 d = square_middle(i);
        float z = depth_at(piece, d), x = d.x, y = d.y;
        if (!covers(piece, d))
            continue;
        vec3 normal = hit.n + x * (along.slope + x * (along.square + x * along.cube)) +
                      y * (down.slope + y * (down.square + y * down.cube)) +
                      x * y * (twist + x * along.cross_square + y * down.cross_square);
        vec2 q = pixel_offset(p) + d;
        Sample at = sample_at(q, STEP, z, normalize(normal), hit.h, hit.n);
        at.dn[0] = along.slope + x * (2.0 * along.square + 3.0 * x * along.cube) +
                   y * (twist + 2.0 * x * along.cross_square + y * down.cross_square);
        at.dn[1] = down.slope + y * (2.0 * down.square + 3.0 * y * down.cube) +
                   x * (twist + x * along.cross_square + 2.0 * y * down.cross_square);
        at.dn[0] *= STEP;
        at.dn[1] *= STEP;
        sum = added(sum, lay_over(behind, at, meet(at), q));
        n += 1.0;
    }
    bool is_whole = end_square - first_square == SQUARES;
    if (is_whole || !is_foremost) {
        if (n > 0.0)
            put_shown(p, scaled(sum, 1.0 / n), 0.0);
        return;
    }
    vec4 light = sum.light + sum.missed * miss;
    if (first_square > 0u)
        light += imageLoad(square_sum, p);
    imageStore(square_sum, p, light);
    if (end_square == SQUARES)
        put_colour(p, light / max(squares_covered(piece), 1.0));
}
