// What each pixel listed at an edge shows. Its quarters are told one by one: how much of a quarter each of the pieces
// of surface around covers, and each piece is shaded for its share of the quarter.
layout(local_size_x = 32) in;  // EDGES_PER_GROUP

layout(binding = 5, r32f) writeonly uniform image2D coverage;

const int PIECES = 4;
const int QUARTERS = 4, PARTS = QUARTERS * PIECES;
const int SIDE = 2;  // SIDE x SIDE squares a quarter
const int SQUARES = SIDE * SIDE;
const float SIZE = 0.5 / float(SIDE);

// The pixel itself first, then by distance.
const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1),
                                 ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));

vec2 square_of(vec2 middle, int i)
{
    return middle + (vec2(i % SIDE, i / SIDE) - 0.5 * float(SIDE - 1)) * SIZE;
}

// Shades the part of a piece that these many squares show, in one go, at their middle.
Shown shade_part(Piece piece, ivec2 p, vec2 place, float n, Shown behind)
{
    float z = depth_at(piece, place), size = sqrt(n) * SIZE;
    return scaled(shade_ray(piece.hit, pixel_offset(p) + place, place - piece.at, size, z, behind), n);
}

// Less of a square is not shaded.
const float LEAST_SEEN = 1e-4;

// As far off the paraboloid of one side, the other side of a crease may be a pixel from it.
const float MEETS_PX = 6.0;

struct Around {
    Piece piece[PIECES];
    vec3 beyond[PIECES];  // of pieces with a rounding: which way the other side of the crease faces
    int n;
    bool beside_empty;
};

// There is no rounding where the other side is not around.
void find_beyond(inout Around around)
{
    for (int k = 0; k < PIECES; k++) {
        float nearest = MEETS_PX;
        for (int j = 0; j < PIECES; j++) {
            float off = off_paraboloid(around.piece[k].hit, around.piece[j].hit.x);
            if (max(j, k) < around.n && j != k && off < nearest) {
                nearest = off;
                around.beyond[k] = around.piece[j].hit.n;
            }
        }
        around.piece[k].rounding = nearest < MEETS_PX ? around.piece[k].rounding : 0.0;
    }
}

// The distinct pieces of surface around.
Around pieces_around(ivec2 p)
{
    Around around;
    around.n = 0;
    around.beside_empty = false;
    float own_depth = imageLoad(hit_depth, p).x;
    float ends = own_depth > 0.0 ? own_depth - 0.25 * pixel_units(own_depth) : NOWHERE;
    for (int i = 0; i < 9; i++) {
        Hit hit = hit_at(p + AROUND[i]);
        around.beside_empty = around.beside_empty || hit.depth == 0.0;
        bool is_new = mirrors(hit);
        for (int k = 0; k < PIECES; k++)
            is_new = is_new && (k >= around.n || !same_surface(around.piece[k].hit, hit));
        if (!is_new || around.n == PIECES)
            continue;
        Piece piece = piece_of(hit, p, AROUND[i]);
        // On a border the paraboloid holds for less than a pixel.
        if (piece.foot == vec2(0.0))
            continue;
        // A piece that would hide what the pixel's centre shows ends before it.
        if (i > 0 && depth_at(piece, vec2(0.0)) < ends && !end_at(piece, vec2(0.0)))
            continue;
        around.piece[around.n++] = piece;
    }
    find_beyond(around);
    return around;
}

Piece piece_at(Around around, int k, out vec3 beyond)
{
    Piece piece = around.piece[0];
    beyond = around.beyond[0];
    for (int i = 1; i < PIECES; i++)
        if (k == i) {
            piece = around.piece[i];
            beyond = around.beyond[i];
        }
    return piece;
}

// How much of each piece the quarter's squares show, and the sum of these squares' middles. Of a square a piece
// gets no more than those in front of it leave: pieces that meet at a crease share a square between them.
void share_quarter(Around around, int quarter, inout vec3 seen[PARTS])
{
    vec2 middle = (vec2(quarter & 1, quarter >> 1) - 0.5) * 0.5;
    vec4 part[PIECES], z[PIECES];
    for (int k = 0; k < PIECES; k++) {
        for (int i = 0; i < SQUARES; i++) {
            z[k][i] = depth_at(around.piece[k], square_of(middle, i));
            bool there = k < around.n && z[k][i] > 0.0;
            part[k][i] = there ? piece_share(around.piece[k], square_of(middle, i), SIZE) : 0.0;
        }
    }
    for (int k = 0; k < PIECES; k++) {
        vec4 left = vec4(1.0);
        for (int j = 0; j < PIECES; j++)
            if (j != k)
                left -= mix(vec4(0.0), part[j], j < k ? lessThanEqual(z[j], z[k]) : lessThan(z[j], z[k]));
        vec4 own = min(part[k], max(left, 0.0));
        vec3 sum = vec3(0.0, 0.0, dot(own, vec4(1.0)));
        for (int i = 0; i < SQUARES; i++)
            sum.xy += own[i] * square_of(middle, i);
        seen[PIECES * quarter + k] = sum;
    }
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

    // What of it is the rounding of a crease.
    vec4 rounded = vec4(0.0);
    uint creases = 0u;
    for (int k = 0; k < PIECES; k++) {
        float share = float(QUARTERS * SQUARES) * rounding_share(around.piece[k]);
        bool is_crease = k < around.n && around.piece[k].rounding > 0.0 && squares[k] > 0.0;
        rounded[k] = is_crease ? min(share, squares[k]) / squares[k] : 0.0;
        creases |= uint(rounded[k] > 0.0) << k;
    }

    Shown behind = shown_behind(p), sum = Shown(vec4(0.0), 0.0);
    vec3 beyond;
    for (; left != 0u; left &= left - 1u) {  // a part each turn, of whatever piece has one left
        int i = findLSB(left), k = i % PIECES;
        vec3 own = seen[i];
        Shown part = shade_part(piece_at(around, k, beyond), p, own.xy / own.z, own.z, behind);
        sum = added(sum, scaled(part, 1.0 - rounded[k]));
    }
    for (; creases != 0u; creases &= creases - 1u) {
        int k = findLSB(creases);
        Piece piece = piece_at(around, k, beyond);
        sum = added(sum, scaled(shade_rounding(piece, beyond, p, behind), rounded[k] * squares[k]));
    }

    // What is between pieces: nothing lies behind, unless something beside is empty.
    float covered = dot(squares, vec4(1.0));
    float open = around.beside_empty ? max(float(QUARTERS * SQUARES) - covered, 0.0) : 0.0;
    float all = covered + open;
    if (all < LEAST_SEEN)
        return;
    put_shown(p, scaled(sum, 1.0 / all), open / all);
    imageStore(coverage, p, vec4(covered / all));
}
