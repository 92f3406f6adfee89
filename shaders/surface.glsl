// Evaluates the limit surface of one node: Stam's exact evaluation in the form of Yasui and Kanai (2004), s(u,v) =
// sum P_i(n,k) b_i(t_kn(u,v)), with uniform cubic B-spline blends b_i. Local coordinates x,y in [0,1] cover the node;
// a CORNER has its extraordinary vertex at (0,0).

struct Surface {
    vec3 s;               // position relative to the eye, camera space, world units
    vec3 su, sv;          // derivatives by the sub-patch's own parameters, divided by scale
    vec3 to_u, to_v;      // tangents: a step d along the surface is dot(to_u, d), dot(to_v, d) in those
                          // parameters, times scale
    vec3 bend;            // the second derivatives uu, uv, vv along n, divided by scale
    vec3 n;               // unit normal, zero where there is none
    float area2;          // |su x sv|^2
    float scale;          // power of two
};

// The four blends at t, and the blends of the three differences of neighbouring points that give the first
// derivative. (The second derivative is that of those differences, linear in t.) Differences come first: where the
// surface is flat they keep digits that single precision loses in sums of points.
void blends(float t, out vec4 value, out vec3 first)
{
    float r = 1.0 - t;
    value = vec4(r * r * r, 4.0 + t * t * (3.0 * t - 6.0), 4.0 + r * r * (3.0 * r - 6.0), t * t * t) *
            (1.0 / 6.0);
    first = vec3(0.5 * r * r, 0.5 + r * t, 0.5 * t * t);
}

// The `lost` of limit_normal(). In a CORNER's frame the coordinates across a cone keep their digits, however thin it
// is.
float lost_square(Node node)
{
    return node.kind == CORNER ? 1e-13 : 1e-8;
}

// The columns are the frame's axes in camera space.
mat3 frame_of(Node node)
{
    mat3 camera = transpose(mat3(axis[0].xyz, axis[1].xyz, axis[2].xyz));
    if (node.kind != CORNER)
        return camera;
#ifdef MADE_PATCHES
    vec4 q = texelFetch(heads, int(4u * node.index));
#else
    vec4 q = texel_at(node.first);
#endif
    vec3 d = 2.0 * q.xyz;
    float xx = q.x * d.x, yy = q.y * d.y, zz = q.z * d.z;
    float xy = q.x * d.y, xz = q.x * d.z, yz = q.y * d.z;
    float wx = q.w * d.x, wy = q.w * d.y, wz = q.w * d.z;
    return camera * mat3(1.0 - (yy + zz), xy + wz, xz - wy, xy - wz, 1.0 - (xx + zz), yz + wx,
                         xz + wy, yz - wx, 1.0 - (xx + yy));
}

// The parameters of the node's level n grow 2^result times as fast as the node's x,y.
ivec2 level_scale(Node node, int level)
{
    return ivec2(node.kind == STRIP ? 0 : level, level);
}

// The sub-patch of a node that holds a place (server/surface/README.md 3.2 and 5).
struct SubPatch {
    ivec2 scale;   // its parameters grow 2^scale times as fast as the node's x,y
    vec2 origin;   // its origin, in those parameters
    vec2 st;       // the place, in [0,1]
    uint scale_at; // the texel of its points' scale
    uint scale_of; // index of the scale among the texel's four numbers
    uint rows;     // its points: 4 rows of 3 texels (server/surface/texels.h)
    uint column;   // not NONE: these points come first in the rows, whose last drop out
    bool limit;    // beyond the last level of a CORNER: the extraordinary vertex itself
};

SubPatch sub_patch_at(Node node, vec2 xy)
{
    bool corner = node.kind == CORNER, strip = node.kind == STRIP;
    float nearest = strip ? xy.y : max(xy.x, xy.y);
    int e;
    frexp(nearest, e);
    int level = nearest > 0.0 ? max(1, 1 - e) : 1000;
    bool limit = corner && level > node.levels;
    level = corner ? min(level, node.levels) : strip ? min(level, node.levels + 1) : 0;
    // The last patch of a strip begins at the crease and is as wide as the patch before it.
    bool last = strip && level > node.levels;
    ivec2 scale = level_scale(node, last ? level - 1 : level);
    vec2 st = ldexp(xy, scale);
    bvec2 far = bvec2(corner && st.x >= 1.0, (corner && st.y >= 1.0) || (strip && !last));
    uint n = uint(max(level, 1)) - 1u;
#ifdef MADE_PATCHES
    uint square = far.y ? (far.x ? 1u : 2u) : 0u;
    uint at = makeTexels(texels, node.index, corner ? 3u * n + square : n);
    return SubPatch(scale, vec2(far), st - vec2(far), at, 0u, at + 1u, NONE, limit);
#else
    uint patches = node.first + (strip ? PATCH_TEXELS * n : 0u);
    uint levels = node.first + 1u + (uint(node.levels) + 3u) / 4u + LEVEL_TEXELS * n;
    return SubPatch(scale, vec2(far), st - vec2(far), corner ? node.first + 1u + n / 4u : patches,
                    corner ? n % 4u : 0u, corner ? levels + (far.y ? 3u : 0u) : patches + 1u,
                    corner && !far.x ? levels + 15u : NONE, limit);
#endif
}

// 16 points as rows of their x, y and z: of row j, x[j][i].
struct Net {
    vec4 x[4], y[4], z[4];
};

void fetch_points(SubPatch patch_, out Net p, out float scale)
{
    scale = texel_at(patch_.scale_at)[patch_.scale_of];
    bool has_column = patch_.column != NONE;
    uint at = has_column ? patch_.column : patch_.rows;
    vec4 x = texel_at(at), y = texel_at(at + 1u), z = texel_at(at + 2u);
    for (uint j = 0u; j < 4u; j++) {
        vec4 row_x = texel_at(patch_.rows + 3u * j), row_y = texel_at(patch_.rows + 3u * j + 1u);
        vec4 row_z = texel_at(patch_.rows + 3u * j + 2u);
        p.x[j] = has_column ? vec4(x[j], row_x.xyz) : row_x;
        p.y[j] = has_column ? vec4(y[j], row_y.xyz) : row_y;
        p.z[j] = has_column ? vec4(z[j], row_z.xyz) : row_z;
    }
}

// The normal of derivatives at st, and |su x sv|^2; zero where there is none. To be taken in the node's
// own frame: there each coordinate keeps its digits where su and sv become parallel, and any rotation
// would mix them.
//
// Where su x sv vanishes because a derivative does (a pole, a collapsed edge) or both are parallel (the
// corner of a patch whose borders meet in one line) the normal is the limit from inside: su x sv as it
// grows towards the patch's middle, to first order: du x sv + su x dv, where du and dv are what su and sv
// gain on the way. That is exact; su x sv a little way inside would be off by its second-order terms.
// Where both derivatives vanish that is zero too, and the second order alone is left: du x dv.
//
// A derivative counts as vanished when its square is below `lost` of the other one's, both below 1e-8 of the
// second ones', where single precision keeps few digits of them. Parallel is what is so to the last digit:
// near the smooth corner of one quad su x sv shrinks to 1e-10 and is still right in the node's frame.
vec3 limit_normal(vec3 su, vec3 sv, vec3 suu, vec3 suv, vec3 svv, vec2 st, float lost, out float area2)
{
    vec3 n = cross(su, sv);
    area2 = dot(n, n);
    float u2 = dot(su, su), v2 = dot(sv, sv);
    bool both_vanish =
        max(u2, v2) < 1e-8 * max(max(dot(suu, suu), dot(svv, svv)), dot(suv, suv));
    bool vanishes = both_vanish || min(u2, v2) < lost * max(u2, v2) || !(area2 > 1e-24 * u2 * v2);
    vec2 inward = 0.5 - st;
    vec3 du = inward.x * suu + inward.y * suv, dv = inward.x * suv + inward.y * svv;
    n = !vanishes ? n : both_vanish ? cross(du, dv) : cross(du, sv) + cross(su, dv);
    float largest = max(max(abs(n.x), abs(n.y)), abs(n.z));
    return largest > 0.0 ? normalize(n / largest) : vec3(0.0);
}

// One row of points along s: the curve at s with its first two derivatives.
void along_row(Net p, int j, float s, vec4 value, vec3 first, out vec3 c, out vec3 d, out vec3 e)
{
    vec4 x = p.x[j], y = p.y[j], z = p.z[j];
    vec3 p0 = vec3(x.x, y.x, z.x), p1 = vec3(x.y, y.y, z.y);
    vec3 p2 = vec3(x.z, y.z, z.z), p3 = vec3(x.w, y.w, z.w);
    vec3 a = p1 - p0, b = p2 - p1, g = p3 - p2;
    c = value.x * p0 + value.y * p1 + value.z * p2 + value.w * p3;
    d = first.x * a + first.y * b + first.z * g;
    e = (1.0 - s) * (b - a) + s * (g - b);
}

// The patch of 16 points at st, with first and second derivatives.
Surface patch_at(Node node, mat3 frame, Net p, float scale, vec2 st)
{
    vec4 bu, bv;
    vec3 du, dv, c[4], d[4], e;
    blends(st.x, bu, du);
    blends(st.y, bv, dv);
    vec3 s = vec3(0.0), su = vec3(0.0), suu = vec3(0.0);
    for (int j = 0; j < 4; j++) {
        along_row(p, j, st.x, bu, du, c[j], d[j], e);
        s += bv[j] * c[j];
        su += bv[j] * d[j];
        suu += bv[j] * e;
    }
    vec3 a = c[1] - c[0], b = c[2] - c[1], g = c[3] - c[2];
    vec3 sv = dv.x * a + dv.y * b + dv.z * g;
    vec3 svv = (1.0 - st.y) * (b - a) + st.y * (g - b);
    vec3 suv = dv.x * (d[1] - d[0]) + dv.y * (d[2] - d[1]) + dv.z * (d[3] - d[2]);
    float area2;
    vec3 n = limit_normal(su, sv, suu, suv, svv, st, lost_square(node), area2);
    // The gradients are computed before any rotation too, since near extraordinary vertices su and sv are nearly
    // parallel; so is the part along n, which is far smaller there than the part across it.
    float to_unit = inversesqrt(area2);
    vec3 to_u = cross(sv, n) * to_unit, to_v = cross(n, su) * to_unit;
    return Surface(node.origin + frame * (s * scale), frame * su, frame * sv, frame * to_u,
                   frame * to_v, vec3(dot(suu, n), dot(suv, n), dot(svv, n)), frame * n, area2,
                   scale);
}

// The limit at the extraordinary vertex itself, where all levels end: the origin and axes of the node's frame. The
// tip of a cone has no tangents, and a crease sector of many faces has no single normal
// (server/surface/subdivision/ring_limit.h).
Surface limit_of(Node node, mat3 frame, float scale)
{
    return Surface(node.origin, frame[0], frame[1], frame[0], frame[1], vec3(0.0),
                   float(node.has_normal) * frame[2], 1.0, scale);
}
