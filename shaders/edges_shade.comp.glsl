// Shades the pixels listed at an edge. For each quarter of a pixel it finds the share that each piece of surface
// around covers, and shades each piece for its share.
layout(local_size_x = 32) in;  // EDGES_PER_GROUP

layout(binding = 5, r32f) writeonly uniform image2D coverage;

const int PIECES = 4;
const int QUARTERS = 4, PARTS = QUARTERS * PIECES;
const uint ALL_STRIPS = (1u << ROUNDING_PARTS) - 1u;
const int SIDE = 2;  // SIDE x SIDE squares per quarter
const int SQUARES = SIDE * SIDE;
const float SIZE = 0.5 / float(SIDE);

// The pixel itself comes first, then the others by distance.
const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1),
                                 ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

vec2 square_of(vec2 middle, int i)
{
    return middle + (vec2(i % SIDE, i / SIDE) - 0.5 * float(SIDE - 1)) * SIZE;
}

// A smaller share of a square is not shaded.
const float LEAST_SEEN = 1e-4;

// A pixel away from a crease, its other side is at most this far off the paraboloid of this side.
const float MEETS_PX = 6.0;

struct Around {
    Piece piece[PIECES];
    int n;
    bool beside_empty;
};

Piece piece_at(Around around, int k)
{
    Piece piece = around.piece[0];
    for (int i = 1; i < PIECES; i++)
        if (k == i)
            piece = around.piece[i];
    return piece;
}

// The normal beyond the crease towards which piece k is rounded; 0 where no pixel around shows that side.
vec3 beyond_crease(Around around, int k)
{
    vec3 beyond = vec3(0.0);
    Hit hit = piece_at(around, k).hit;
    float nearest = MEETS_PX;
    for (int j = 0; j < PIECES; j++) {
        float off = off_paraboloid(hit, around.piece[j].hit.x);
        if (j < around.n && j != k && off < nearest) {
            nearest = off;
            beyond = around.piece[j].hit.n;
        }
    }
    return beyond;
}

// The distinct pieces of surface around.
Around pieces_around(ivec2 p)
{
    Around around;
    around.n = 0;
    around.beside_empty = false;
    float own_depth = imageLoad(hit_depth, p).x;
    float before = own_depth > 0.0 ? own_depth - 0.25 * pixel_units(own_depth) : NOWHERE;
    for (int i = 0; i < 9; i++) {
        Hit hit = hit_at(p + AROUND[i]);
        around.beside_empty = around.beside_empty || hit.depth <= 0.0;
        bool is_new = mirrors(hit);
        for (int k = 0; k < PIECES; k++)
            if (is_new && k < around.n && same_surface(around.piece[k].hit, hit)) {
                add_ends(around.piece[k], p, AROUND[i]);
                is_new = false;
            }
        if (!is_new || around.n == PIECES)
            continue;
        if (is_in_rounding(p + AROUND[i]))
            continue;
        Piece piece = piece_of(hit, p, AROUND[i]);
        for (int k = 0; k < PIECES; k++)  // no store at a computed index: some devices then keep the array in memory
            if (k == around.n)
                around.piece[k] = piece;
        around.n++;
    }
    // A piece that would hide what the pixel's centre shows must end before the centre.
    for (int k = 0; k < PIECES; k++)
        if (k < around.n && around.piece[k].at != vec2(0.0) && depth_at(around.piece[k], vec2(0.0)) < before &&
            !end_at(around.piece[k], vec2(0.0)))
            around.piece[k].is_hidden = true;
    return around;
}

// Writes how much of each piece the quarter's squares show, and the sum of these squares' middles. In each square a
// piece gets at most what the pieces in front of it leave: pieces that meet at a crease share a square.
void share_quarter(Around around, int quarter, inout vec3 seen[PARTS])
{
    vec2 middle = (vec2(quarter & 1, quarter >> 1) - 0.5) * 0.5;
    vec3 sum[PIECES] = vec3[PIECES](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    for (int i = 0; i < SQUARES; i++) {
        vec2 square = square_of(middle, i);
        vec4 part, z;  // of each piece
        for (int k = 0; k < PIECES; k++) {
            z[k] = depth_at(around.piece[k], square);
            bool there = k < around.n && z[k] > 0.0 && !around.piece[k].is_hidden;
            part[k] = there ? piece_share(around.piece[k], square, SIZE) : 0.0;
        }
        for (int k = 0; k < PIECES; k++) {
            float left = 1.0;
            for (int j = 0; j < PIECES; j++)
                if (j != k)
                    left -= (j < k ? z[j] <= z[k] : z[j] < z[k]) ? part[j] : 0.0;
            float own = min(part[k], max(left, 0.0));
            sum[k] += vec3(own * square, own);
        }
    }
    for (int k = 0; k < PIECES; k++)
        seen[PIECES * quarter + k] = sum[k];
}

void main()
{
    uint index = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * EDGES_PER_GROUP + gl_LocalInvocationIndex;
    if (index >= listed.n)
        return;
    ivec2 p = list_place(listed.at[index]);
    Around around = pieces_around(p);
    vec3 seen[PARTS];
    for (int quarter = 0; quarter < QUARTERS; quarter++)
        share_quarter(around, quarter, seen);
    uint left = 0u;
    vec4 squares = vec4(0.0);  // of each piece
    for (int i = 0; i < PARTS; i++) {
        left |= uint(seen[i].z > LEAST_SEEN) << i;
        squares[i % PIECES] += seen[i].z > LEAST_SEEN ? seen[i].z : 0.0;
    }

    // The part of that which is the rounding of a crease.
    vec4 rounded = vec4(0.0);
    vec3 beyond[PIECES];
    uint creases = 0u;
    for (int k = 0; k < PIECES; k++)
        creases |= uint(k < around.n && around.piece[k].rounding > 0.0 && squares[k] > 0.0) << k;
    for (; creases != 0u; creases &= creases - 1u) {
        int k = findLSB(creases);
        vec3 other = beyond_crease(around, k);
        float share = float(QUARTERS * SQUARES) * rounding_share(piece_at(around, k));
        for (int i = 0; i < PIECES; i++)
            if (i == k && other != vec3(0.0)) {
                beyond[i] = other;
                rounded[i] = min(share, squares[i]) / squares[i];
                left |= rounded[i] > 0.0 ? ALL_STRIPS << PARTS + ROUNDING_PARTS * i : 0u;
            }
    }

    // Each turn shades one part, of any piece that has one left; the strips of roundings follow. All of it is one
    // loop because the code of light and pattern is long, and so is compiled once.
    Shown behind = shown_behind(p), sum = Shown(vec4(0.0), 0.0);
    for (; left != 0u; left &= left - 1u) {
        int i = findLSB(left), strip = i - PARTS;
        bool is_strip = strip >= 0;
        int k = is_strip ? strip / ROUNDING_PARTS : i % PIECES;
        vec3 own = seen[min(i, PARTS - 1)];
        Piece piece = piece_at(around, k);
        vec2 place = is_strip ? rounding_place(piece) : own.xy / own.z, q = pixel_offset(p) + place;
        float z = depth_at(piece, place);
        vec3 side = normal_at(piece.hit, move_to(piece.hit, place - piece.at, q, z));
        Strip part = is_strip ? rounding_strip(piece, side, beyond[k], strip % ROUNDING_PARTS)
                              : Strip(mat2(sqrt(own.z) * SIZE), side, vec3(0.0));
        Sample at = sample_over(q, part.sides, z, part.n, piece.hit.h, piece.hit.n);
        at.dn[0] = is_strip ? part.turn : at.dn[0];
        float n = is_strip ? rounded[k] * squares[k] / float(ROUNDING_PARTS) : own.z * (1.0 - rounded[k]);
        sum = added(sum, scaled(lay_over(behind, at, meet(at), q), n));
    }

    // What no piece covers: nothing is behind it only if something beside the pixel is empty.
    float covered = dot(squares, vec4(1.0));
    float open = around.beside_empty ? max(float(QUARTERS * SQUARES) - covered, 0.0) : 0.0;
    float all = covered + open;
    if (all < LEAST_SEEN)
        return;
    put_shown(p, scaled(sum, 1.0 / all), open / all);
    imageStore(coverage, p, vec4(covered / all));
}
