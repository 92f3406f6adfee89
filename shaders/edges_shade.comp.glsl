// What each listed pixel shows: rays spread over it against the pieces of surface around, each a
// paraboloid clipped by its border's line; and each ray shaded for its own share of the pixel.
//
// Until the foremost light the colour is the surface's alone; what is empty comes in with that.

layout(local_size_x = 64) in;

layout(binding = 3, rgba8) uniform image2D colour;
layout(binding = 5, r32f) writeonly uniform image2D coverage;

const int PIECES = 4;
const int SIDE = 4, SIDE_SMOOTH = 2;  // SIDE x SIDE rays

// The pixel itself first, then by distance.
const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1),
                                 ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

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
    piece.foot = unpackHalf2x16(imageLoad(border, p + at).x);
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

// side x side squares make up the pixel. A ray through each says what is seen there, one in each of the
// pixel's side^2 rows and columns.
vec2 square_of(int i, int side)
{
    return (vec2(i % side, i / side) + 0.5) / float(side) - 0.5;
}

vec2 ray_in(vec2 square, int side)
{
    return square + square.yx / float(side);
}

// d: from the hit's own pixel, px; size: of its square.
vec4 shade_ray(Hit hit, vec2 q, vec2 d, float size, float z, vec4 under)
{
    vec3 across = (axis[0].xyz * d.x + axis[1].xyz * d.y) * pixel_units(hit.depth);
    vec3 move = across + to_world(vec3(q * ray.x, 1.0)) * (z - hit.depth);
    vec4 place = vec4(hit.x + move, z);
    Sample at = sample_at(q, size, place, normal_at(hit, move), hit.h, hit.n);
    return lay_over(under, at, meet(at), q);
}

vec4 premultiplied(vec4 c)
{
    return vec4(c.rgb * c.a, c.a);
}

vec4 straight(vec4 c)
{
    return vec4(c.a > 0.0 ? c.rgb / c.a : vec3(0.0), c.a);
}

void main()
{
    if (gl_GlobalInvocationID.x >= n_edges)
        return;
    uint listed = edges[gl_GlobalInvocationID.x];
    bool is_smooth = (listed & SMOOTH) != 0u;
    ivec2 p = ivec2(listed & 0xffffu, (listed & ~SMOOTH) >> 16);
    int side = is_smooth ? SIDE_SMOOTH : SIDE;

    // The distinct pieces of surface around.
    Piece pieces[PIECES];
    int n = 0;
    bool beside_empty = false;
    float own_depth = imageLoad(position, p).w;
    bool is_hit = own_depth > 0.0;
    for (int i = 0; i < (is_smooth ? 1 : 9); i++) {
        ivec2 q = p + AROUND[i];
        Hit hit = hit_at(q);
        beside_empty = beside_empty || hit.depth == 0.0;
        bool is_new = hit.depth > 0.0 && dot(hit.n, hit.n) > 0.5;
        for (int k = 0; k < PIECES; k++)
            is_new = is_new && (k >= n || !same_surface(pieces[k].hit, hit));
        if (!is_new || n == PIECES)
            continue;
        Piece piece = piece_of(hit, p, AROUND[i]);
        // On a border the paraboloid holds for less than a pixel.
        if (piece.foot == vec2(0.0))
            continue;
        // A piece that would hide what the pixel's centre shows ends before it, who knows how.
        if (i > 0) {
            float z = depth_at(piece, -0.3 * normalize(piece.at));
            if (z < (is_hit ? own_depth - 0.25 * pixel_units(own_depth) : NOWHERE))
                continue;
        }
        pieces[n++] = piece;
    }
    if (n == 0)
        return;

    vec4 under = is_hindmost ? miss : imageLoad(colour, p), sum = vec4(0.0);
    float covered = 0.0, open = 0.0;
    for (int i = 0; i < side * side; i++) {
        vec2 square = square_of(i, side), place = ray_in(square, side);
        float nearest = NOWHERE;
        Piece piece;
        for (int k = 0; k < PIECES; k++) {
            float z = k < n ? depth_at(pieces[k], place) : NOWHERE;
            if (z < nearest) {
                nearest = z;
                piece = pieces[k];
            }
        }
        if (nearest < NOWHERE) {
            covered += 1.0;
            float z = depth_at(piece, square);
            // The square's middle, where squares tile the pixel, unless the piece does not reach it.
            if (z < NOWHERE) {
                place = square;
                nearest = z;
            }
            vec2 d = place - piece.at;
            vec2 q = pixel_offset(p) + place;
            sum += premultiplied(shade_ray(piece.hit, q, d, 1.0 / float(side), nearest, under));
        } else if (beside_empty) {  // else a gap between pieces: nothing lies behind
            open += 1.0;
        }
    }
    if (covered == 0.0 && open == 0.0)
        return;
    float rays = is_foremost ? covered + open : covered;
    if (is_foremost)
        sum += open * premultiplied(empty);
    imageStore(colour, p, straight(sum / max(rays, 1.0)));
    imageStore(coverage, p, vec4(covered / (covered + open)));
}
