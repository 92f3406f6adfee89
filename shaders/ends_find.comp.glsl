// Finds where the pieces end that listed pixels show (ends.glsl), by Newton's method on the surface itself. (The
// paraboloid at the pixel has a silhouette too, but it is far off where the surface bends within pixels; and stage 2
// knows borders only to first order.)
//
// Let f(s,t) be the distance of the surface from the pixel's ray, perpendicular to it (newton.glsl). The silhouette
// is where fs x ft = 0: there f moves along one direction only, and the nearest place is where f is perpendicular to
// it. On a border the nearest place is where f is perpendicular to the border's own direction.

layout(local_size_x = 64) in;

layout(binding = 5, rg32ui) uniform uimage2D ends;

LIST(0, Listed, listed);

const float FARTHEST_PX = 3.0;
const float MOST_BEYOND_PX = 0.25;  // a hit may lie so far outside its silhouette
const int SILHOUETTE_STEPS = 6, SILHOUETTE_PATCHES = 3;
// Newton's method ends at a step smaller than LAST_STEP of a sub-patch; a sub-patch's polynomials are used up to
// BEYOND outside its border.
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

// Distance between neighbouring pixels' rays at the depth of the place st: ends may be much deeper than the pixel's
// hit.
float pixel_units_at(Node node, mat3 frame, Net p, float scale, vec2 st)
{
    vec4 bu, bv;
    vec3 du, dv, forward = vec3(0.0, 0.0, 1.0) * frame;
    blends(st.x, bu, du);
    blends(st.y, bv, dv);
    float z = 0.0;
    for (int j = 0; j < 4; j++)
        z += bv[j] * dot(bu, forward.x * p.x[j] + forward.y * p.y[j] + forward.z * p.z[j]);
    return pixel_units(node.origin.z + scale * z);
}

float turn(vec2 a, vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

// A step towards the place where fs x ft = 0 and f is perpendicular to the direction that remains.
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

// The outward direction at a silhouette: away from the side to which the surface bends.
vec2 outwards(Derivatives at)
{
    vec2 along = dot(at.fu, at.fu) > dot(at.fv, at.fv) ? at.fu : at.fv;
    vec2 still = normalize(vec2(dot(at.fv, along), -dot(at.fu, along)));
    vec2 bend = still.x * still.x * at.fuu + 2.0 * still.x * still.y * at.fuv + still.y * still.y * at.fvv;
    vec2 across = normalize(vec2(-along.y, along.x));
    return dot(bend, across) > 0.0 ? -across : across;
}

// The silhouette's end, or NO_END if none is near. A pixel in a gap (gaps.comp.glsl) shows another piece than stage 1
// saw there, so its guess does not lead to the silhouette of the piece it shows.
uint silhouette_end(ivec2 p)
{
    Guess guess = guess_of(p);
    if (guess.node == UNSEEN || is_in_gap(texelFetch(seen, p, 0).x))
        return NO_END;
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
            vec2 outward = outwards(at), f_px = at.f * scale / pixel_units_at(node, frame, points, scale, st);
            float off_px = dot(f_px, outward);
            bool has_settled = inside && max(abs(move.x), abs(move.y)) < LAST_STEP;
            bool is_near = length(f_px) < FARTHEST_PX && off_px > -MOST_BEYOND_PX;
            return has_settled && is_near ? pack_end(outward, max(off_px, NEAREST_END), 0.0) : NO_END;
        }
        xy = ldexp(own.origin + st, -own.scale);
        if (own.limit || !walk(node, xy))
            break;
    }
    return NO_END;
}

// The place at t along edge e of a face, and the directions in the node's coordinates along t and away from the edge.
void edge_place(uint face, uint e, float t, out Node node, out vec2 xy, out vec2 along, out vec2 inwards)
{
    node_under(Place(face, e, vec2(t, 0.0)), node, xy);
    uint k = (e + 4u - node.rotation) & 3u;
    along = k == 0u ? vec2(1.0, 0.0) : k == 1u ? vec2(0.0, 1.0) : k == 2u ? vec2(-1.0, 0.0) : vec2(0.0, -1.0);
    inwards = vec2(-along.y, along.x);
}

const int BORDER_PATCHES = 4, BORDER_NEWTON_STEPS = 4;

// The line of edge e of a face, at the place nearest to the pixel's centre; the search starts at t. Writes the line's
// direction and its distance, px. False if there is none near.
bool border_end(ivec2 p, uint face, uint e, inout float t, out vec2 across, out float off)
{
    bool found = false;
    for (int i = 0; i < BORDER_PATCHES; i++) {
        Node node;
        vec2 xy, along, inwards;
        edge_place(face, e, t, node, xy, along, inwards);
        if (node.kind == HOLE)
            return false;
        SubPatch own = sub_patch_at(node, xy);
        Net points;
        float scale;
        fetch_points(own, points, scale);
        mat3 frame = frame_of(node);
        FlatNet net = project(node, frame, points, scale, ray_of(p));
        vec2 st = own.st, ft;
        Derivatives at;
        float left;
        for (int k = 0; k < BORDER_NEWTON_STEPS; k++) {
            at = derivatives_at(net, st);
            ft = along.x * at.fu + along.y * at.fv;
            vec2 ftt = along.x * along.x * at.fuu + 2.0 * along.x * along.y * at.fuv + along.y * along.y * at.fvv;
            float slope = dot(ft, ft);
            float move = -dot(at.f, ft) / max(slope + dot(at.f, ftt), 0.3 * slope);
            float to = dot(st + move * along, abs(along)), next = clamp(to, 0.0, 1.0);
            left = to - next;
            st = mix(st, vec2(next), abs(along));
            if (abs(move) < LAST_STEP || left != 0.0)
                break;
        }
        at = derivatives_at(net, st);
        ft = along.x * at.fu + along.y * at.fv;
        across = normalize(vec2(-ft.y, ft.x));
        across = dot(inwards.x * at.fu + inwards.y * at.fv, across) > 0.0 ? -across : across;
        vec2 f_px = at.f * scale / pixel_units_at(node, frame, points, scale, st);
        off = dot(f_px, across);
        found = off > -MOST_BEYOND_PX && length(f_px) < FARTHEST_PX;
        vec2 onwards = left == 0.0 || own.limit ? vec2(0.0) : clamp(left, -2.0, 2.0) * abs(along);
        float next_t = clamp(turned(ptex_uv(node, ldexp(own.origin + st + onwards, -own.scale)), e).x, 0.0, 1.0);
        bool is_there = onwards == vec2(0.0) || abs(next_t - t) < 1e-7;
        t = next_t;
        if (is_there)
            break;
    }
    return found;
}

// The sign of the side that the surface shows at a place.
float facing_at(ivec2 p, Node node, vec2 xy)
{
    if (node.kind == HOLE)
        return 0.0;
    SubPatch own = sub_patch_at(node, xy);
    Net points;
    float scale;
    fetch_points(own, points, scale);
    Derivatives at = derivatives_at(project(node, frame_of(node), points, scale, ray_of(p)), own.st);
    return turn(at.fu, at.fv);
}

// Whether the other side of a crease, beyond its rounding, shows the same face to the eye.
bool goes_on(ivec2 p, uint face, uint e, float t, float rounding, float own_facing)
{
    Place place = Place(face, e, vec2(t, 0.0));
    if (!across_edge(place, e, true, t, rounding))
        return false;
    settle(place);
    Node node;
    vec2 xy;
    node_under(place, node, xy);
    return facing_at(p, node, xy) * own_facing > 0.0;
}

// The border's end, or NO_END if it is not found; then the border of stage 2 stands.
uint border_end_of(ivec2 p, float rounding_px)
{
    Guess guess = guess_of(p);
    if (guess.node == UNSEEN || is_in_gap(texelFetch(seen, p, 0).x))
        return NO_END;
    Node node = node_load(guess.node);
    vec2 xy = guess_xy(node, guess.where), uv = ptex_uv(node, xy), nearest_across;
    uint nearest = NONE;
    float nearest_off = FARTHEST_PX, nearest_t;
    for (uint e = 0u; e < 4u; e++) {
        float t = turned(uv, e).x, off;
        vec2 across;
        if ((node.borders >> 4u * ((e - node.rotation) & 3u) & 15u) != 0u &&
            border_end(p, node.face, e, t, across, off) && off < nearest_off) {
            nearest = e;
            nearest_off = off;
            nearest_across = across;
            nearest_t = t;
        }
    }
    if (nearest == NONE)
        return NO_END;
    float rounding = ldexp(1.0, -int(node.borders >> 4u * ((nearest - node.rotation) & 3u) & 15u));
    uint end = pack_end(nearest_across, max(nearest_off, NEAREST_END), rounding_px);
    bool shows = goes_on(p, node.face, nearest, nearest_t, rounding, facing_at(p, node, xy));
    return shows ? end | END_GOES_ON : end;
}

void main()
{
    uint i = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (i >= listed.n)
        return;
    ivec2 p = list_place(listed.at[i]);
    uint to_border = imageLoad(ends, p).y;
    if (to_border != NO_END && end_off(to_border) > 0.0) {
        uint exact = border_end_of(p, end_rounding(to_border));
        to_border = exact == NO_END ? to_border : exact;
    }
    imageStore(ends, p, uvec4(silhouette_end(p), to_border, 0u, 0u));
}
