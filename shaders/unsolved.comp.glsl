// Stage 2, evaluate, second pass: the pixels that evaluate.comp.glsl listed.
//
// Newton's method may now walk over the borders of sub-patches, nodes and faces, and the ray
// decides coverage: guesses of the pixels around are tried where the pixel has none, where its own
// fails, and where a neighbour lies in front; the nearest solution wins. So a silhouette is where
// the surface ends, and a crack between grids of different fineness cannot show.

layout(local_size_x = 64) in;

const int STEPS = 12;

struct Hit {
    Node node;
    vec2 xy;
    ivec2 steps;  // the surface's parameters run 2^steps faster
    Surface surface;
};

struct Solution {
    bool found;
    Hit hit;
};

const ivec2 AROUND[5] =
    ivec2[5](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

// Inside the last ring of an extraordinary vertex (2^-32 of the node) the surface is its tangent
// plane there; at a cone's tip, a plane across the view.
bool meet_limit(Node node, Ray r, inout Surface s)
{
    vec3 o = vec3(r.start, 0.0), d = vec3(r.slope, 1.0);
    vec3 n = dot(s.n, s.n) > 0.0 ? s.n : vec3(0.0, 0.0, 1.0);
    float z = dot(n, node.origin - o) / dot(n, d);
    s.s = o + z * d;
    return z > 0.0 && distance(s.s, node.origin) < 2.0 * s.scale;
}

// From a guess to the place on the ray; not found when there is none near.
Solution solve(uvec2 guess, Ray r)
{
    Solution result;
    result.found = false;
    uint index = guess.x;
    Node node = node_load(index);
    vec2 xy = guess_xy(node, guess.y);
    for (int i = 0; i < STEPS; i++) {
        vec2 step_st, net[16];
        vec3 points16[16];
        float scale;
        mat3 frame = frame_of(node);
        SubPatch own = sub_patch_at(node, xy);
        fetch_points(own, points16, scale);
        Surface s = own.limit ? limit_of(node, frame, scale)
                              : patch_at(node, frame, points16, scale, own.st);
        project(node, frame, points16, scale, r, net);
        vec2 f = s.s.xy - r.start - r.slope * s.s.z;
        newton_step(net, own.st, step_st);
        if (own.limit) {
            result.found = meet_limit(node, r, s);
            result.hit = Hit(node, xy, own.scale, s);
            break;
        }
        float residual = length(f) / pixel_units(s.s.z);
        float enough = close_enough(scale / pixel_units(s.s.z));
        bool last = i == STEPS - 1 || step_st == vec2(0.0);
        if (residual < enough || last || !(s.s.z > 0.0)) {
            result.found = residual < 4.0 * enough && s.s.z > 0.0;
            result.hit = Hit(node, xy, own.scale, s);
            break;
        }
        xy += ldexp(step_st, -own.scale);
        if (any(lessThan(xy, vec2(0.0))) || any(greaterThan(xy, vec2(1.0)))) {
            Place place = place_of(node, xy);
            settle(place);
            index = node_under(place, node, xy);
            if (node.kind == HOLE)
                break;
        }
    }
    return result;
}

void main()
{
    if (gl_GlobalInvocationID.x >= n_unsolved)
        return;
    uint at = unsolved[gl_GlobalInvocationID.x];
    ivec2 p = ivec2(at & 0xffffu, at >> 16);
    Ray r = ray_of(p);
    Solution best;
    best.found = false;
    for (int i = 0; i < 5; i++) {
        ivec2 q = clamp(p + AROUND[i], ivec2(0), tile.zw - 1);
        uvec2 guess = texelFetch(seen, q, 0).xy;
        if (guess.x == NONE)
            continue;
        Solution other = solve(guess, r);
        if (other.found && (!best.found || other.hit.surface.s.z < best.hit.surface.s.z))
            best = other;
    }
    if (best.found)
        store_hit(p, best.hit.node, best.hit.xy, best.hit.steps, best.hit.surface);
    else
        store_miss(p);
}
