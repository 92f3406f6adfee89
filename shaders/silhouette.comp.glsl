// Where the pieces that listed pixels show end at their silhouettes: for each pixel the foot of the perpendicular
// from its centre on the silhouette's line in the picture, by Newton's method on the surface itself. (The
// paraboloid at the pixel has a silhouette too, but where the surface bends within pixels it is far off.)
//
// With f(s,t) how far the surface is from the pixel's ray, across it (newton.glsl), the silhouette is where
// fs x ft = 0; there all that f moves is along one direction, and the nearest place is where f is across that.

layout(local_size_x = 64) in;

layout(binding = 5, r32ui) writeonly uniform uimage2D silhouette;

LIST(0, Listed, listed);

const float FARTHEST_PX = 3.0;
const float MOST_BEYOND_PX = 0.25;  // a hit may lie so far outside its own silhouette, by rounding and by the guess
const int SILHOUETTE_STEPS = 6, SILHOUETTE_PATCHES = 3;
// The step of a sub-patch below which Newton's method has come to its end, and how far beyond a sub-patch's
// border its polynomials tell enough.
const float LAST_STEP = 0.01, BEYOND = 0.1;

struct Derivatives {
    vec2 f, fu, fv, fuu, fuv, fvv;
};

Derivatives derivatives_at(FlatNet net, vec2 st)
{
    vec4 bu, bv;
    vec3 du, dv;
    blends(st.x, bu, du);
    blends(st.y, bv, dv);
    vec2 c[4], d[4];
    Derivatives at;
    at.f = at.fu = at.fuu = vec2(0.0);
    for (int j = 0; j < 4; j++) {
        vec3 x = net.x[j].yzw - net.x[j].xyz, y = net.y[j].yzw - net.y[j].xyz;
        c[j] = vec2(dot(bu, net.x[j]), dot(bu, net.y[j]));
        d[j] = vec2(dot(du, x), dot(du, y));
        vec2 first = vec2(x.y - x.x, y.y - y.x), second = vec2(x.z - x.y, y.z - y.y);
        at.f += bv[j] * c[j];
        at.fu += bv[j] * d[j];
        at.fuu += bv[j] * mix(first, second, st.x);
    }
    vec2 a = c[1] - c[0], b = c[2] - c[1], g = c[3] - c[2];
    at.fv = dv.x * a + dv.y * b + dv.z * g;
    at.fvv = mix(b - a, g - b, st.y);
    at.fuv = dv.x * (d[1] - d[0]) + dv.y * (d[2] - d[1]) + dv.z * (d[3] - d[2]);
    return at;
}

float turn(vec2 a, vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

// Towards where fs x ft = 0 and f is across what is left of the two.
vec2 silhouette_step(Derivatives at)
{
    vec2 along = dot(at.fu, at.fu) > dot(at.fv, at.fv) ? at.fu : at.fv;
    float facing = turn(at.fu, at.fv), off = dot(at.f, along);
    vec2 d_facing = vec2(turn(at.fuu, at.fv) + turn(at.fu, at.fuv), turn(at.fuv, at.fv) + turn(at.fu, at.fvv));
    vec2 d_off = vec2(dot(at.fu, along), dot(at.fv, along));
    float det = turn(d_facing, d_off);
    vec2 move = -vec2(facing * d_off.y - off * d_facing.y, off * d_facing.x - facing * d_off.x) / det;
    float longest = max(abs(move.x), abs(move.y));
    return move * min(1.0, 0.5 / max(longest, 1e-30));
}

// Outwards: the surface lies where it bends to.
vec2 outwards(Derivatives at)
{
    vec2 along = dot(at.fu, at.fu) > dot(at.fv, at.fv) ? at.fu : at.fv;
    vec2 still = normalize(vec2(dot(at.fv, along), -dot(at.fu, along)));
    vec2 bend = still.x * still.x * at.fuu + 2.0 * still.x * still.y * at.fuv + still.y * still.y * at.fvv;
    vec2 across = normalize(vec2(-along.y, along.x));
    return dot(bend, across) > 0.0 ? -across : across;
}

// NO_BORDER where there is none near. A pixel in a gap (gaps.comp.glsl) shows another piece than stage 1 saw there,
// so nothing leads to the silhouette of what it shows.
vec2 silhouette_foot(ivec2 p)
{
    Guess guess = guess_of(p);
    if (guess.node == UNSEEN || is_in_gap(texelFetch(seen, p, 0).x))
        return NO_BORDER;
    float px = pixel_units(guess.depth);
    Node node = node_load(guess.node);
    vec2 xy = guess_xy(node, guess.where);
    for (int i = 0; i < SILHOUETTE_PATCHES; i++) {
        Net points;
        float scale;
        mat3 frame = frame_of(node);
        SubPatch own = sub_patch_at(node, xy);
        fetch_points(own, points, scale);
        FlatNet net = project(node, frame, points, scale, ray_of(p));
        vec2 st = own.st, move;
        Derivatives at;
        for (int k = 0; k < SILHOUETTE_STEPS; k++) {
            at = derivatives_at(net, st);
            move = silhouette_step(at);
            st += move;
            if (max(abs(move.x), abs(move.y)) < LAST_STEP || any(lessThan(st, vec2(-0.5))) || any(greaterThan(st, vec2(1.5))))
                break;
        }
        bool inside = all(greaterThanEqual(st, vec2(-BEYOND))) && all(lessThanEqual(st, vec2(1.0 + BEYOND)));
        if (inside || i == SILHOUETTE_PATCHES - 1) {
            at = derivatives_at(net, st);
            vec2 outward = outwards(at);
            float off_px = dot(at.f, outward) * scale / px;
            bool has_settled = inside && max(abs(move.x), abs(move.y)) < LAST_STEP;
            bool is_near = length(at.f) * scale / px < FARTHEST_PX && off_px > -MOST_BEYOND_PX;
            return has_settled && is_near ? outward * max(off_px, 2.0 / BORDER_STEPS) : NO_BORDER;
        }
        xy = ldexp(own.origin + st, -own.scale);
        if (own.limit || !walk(node, xy))
            break;
    }
    return NO_BORDER;
}

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    imageStore(silhouette, p, uvec4(pack_border(silhouette_foot(p), 0.0)));
}
