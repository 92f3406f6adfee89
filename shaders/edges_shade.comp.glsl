// What each pixel listed at an edge shows: rays spread over it against the pieces of surface around,
// and each piece shaded for its share of each quarter of the pixel.

layout(local_size_x = 64) in;

layout(binding = 5, r32f) writeonly uniform image2D coverage;

const int PIECES = 4;
const int SIDE = 4;  // SIDE x SIDE rays

// The pixel itself first, then by distance.
const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1),
                                 ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

// SIDE x SIDE squares make up the pixel. A ray through each says what is seen there, one in each of the
// pixel's SIDE^2 rows and columns.
vec2 square_of(int i)
{
    return (vec2(i % SIDE, i / SIDE) + 0.5) / float(SIDE) - 0.5;
}

vec2 ray_in(vec2 square)
{
    return square + square.yx / float(SIDE);
}

// The rays of the first quarter of the pixel, as bits.
const uint QUARTER = 0x33u;

// Shades the part of a piece that these rays of one quarter see, in one go: at the middle of their
// squares, or where the piece does not reach that, at the middle of the rays.
Shown shade_part(Piece piece, ivec2 p, uint rays, Shown behind)
{
    vec2 squares = vec2(0.0);
    float n = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        float seen = float(rays >> i & 1u);
        squares += seen * square_of(i);
        n += seen;
    }
    squares /= n;
    vec2 place = squares;
    float z = depth_at(piece, place);
    if (z == NOWHERE) {
        place = ray_in(squares);
        z = depth_at(piece, place);
    }
    z = z < NOWHERE ? z : piece.hit.depth;
    float size = sqrt(n) / float(SIDE);
    return scaled(shade_ray(piece.hit, pixel_offset(p) + place, place - piece.at, size, z, behind), n);
}

Piece piece_at(Piece pieces[PIECES], int k)
{
    Piece piece = pieces[0];
    for (int i = 1; i < PIECES; i++)
        if (k == i)
            piece = pieces[i];
    return piece;
}

// As far off the paraboloid of one side, the other side of a crease may be a pixel from it.
const float MEETS_PX = 6.0;

void main()
{
    uint index = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (index >= listed.n)
        return;
    ivec2 p = list_place(listed.at[index]);

    // The distinct pieces of surface around.
    Piece pieces[PIECES];
    int n = 0;
    bool beside_empty = false;
    float own_depth = imageLoad(hit_depth, p).x;
    bool is_hit = own_depth > 0.0;
    for (int i = 0; i < 9; i++) {
        ivec2 q = p + AROUND[i];
        Hit hit = hit_at(q);
        beside_empty = beside_empty || hit.depth == 0.0;
        bool is_new = mirrors(hit);
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

    // Which rays see which piece.
    uint seen[PIECES] = uint[PIECES](0u, 0u, 0u, 0u);
    float covered = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        vec2 place = ray_in(square_of(i));
        float nearest = NOWHERE;
        int which = PIECES;
        for (int k = 0; k < PIECES; k++) {
            float z = k < n ? depth_at(pieces[k], place) : NOWHERE;
            which = z < nearest ? k : which;
            nearest = min(z, nearest);
        }
        for (int k = 0; k < PIECES; k++)
            seen[k] |= uint(which == k) << i;
        covered += float(which < PIECES);
    }
    // Rays between pieces: nothing lies behind, unless something beside is empty.
    float open = beside_empty ? float(SIDE * SIDE) - covered : 0.0;
    if (covered == 0.0 && open == 0.0)
        return;

    // What of it is the rounding of a crease.
    float rounded[PIECES];
    vec3 beyond[PIECES];
    uint creases = 0u;
    for (int k = 0; k < PIECES; k++) {
        float nearest = MEETS_PX, seen_by = float(bitCount(seen[k]));
        for (int j = 0; j < PIECES; j++) {
            float off = off_paraboloid(pieces[k].hit, pieces[j].hit.x);
            if (max(j, k) < n && j != k && off < nearest) {
                nearest = off;
                beyond[k] = pieces[j].hit.n;
            }
        }
        bool is_crease = k < n && nearest < MEETS_PX && pieces[k].rounding > 0.0 && seen_by > 0.0;
        float share = float(SIDE * SIDE) * rounding_share(pieces[k]);
        rounded[k] = is_crease ? min(share, seen_by) / seen_by : 0.0;
        creases |= uint(rounded[k] > 0.0) << k;
    }

    Shown behind = shown_behind(p), sum = Shown(vec4(0.0), 0.0);
    uvec4 left = uvec4(seen[0], seen[1], seen[2], seen[3]);
    while (left != uvec4(0u)) {  // a part each turn, of whatever piece has one left
        int k = left.x != 0u ? 0 : left.y != 0u ? 1 : left.z != 0u ? 2 : 3;
        uint rays = k == 0 ? left.x : k == 1 ? left.y : k == 2 ? left.z : left.w;
        int first = findLSB(rays);
        uint quarter = QUARTER << ((first & 2) | (first & 8));
        left &= ~(quarter * uvec4(equal(ivec4(k), ivec4(0, 1, 2, 3))));
        float plain = 1.0 - (k == 0 ? rounded[0] : k == 1 ? rounded[1] : k == 2 ? rounded[2] : rounded[3]);
        sum = added(sum, scaled(shade_part(piece_at(pieces, k), p, rays & quarter, behind), plain));
    }
    for (; creases != 0u; creases &= creases - 1u) {
        int k = findLSB(creases);
        float rays = rounded[k] * float(bitCount(seen[k]));
        sum = added(sum, scaled(shade_rounding(piece_at(pieces, k), beyond[k], p, behind), rays));
    }
    float rays = covered + open;
    put_shown(p, scaled(sum, 1.0 / rays), open / rays);
    imageStore(coverage, p, vec4(covered / rays));
}
