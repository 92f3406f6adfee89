// Stage 2, evaluate, second pass: the pixels that evaluate.comp.glsl listed.
//
// Newton's method may now walk over the borders of sub-patches, nodes and faces, and the ray
// decides coverage: guesses of the pixels around are tried where the pixel has none, where its own
// fails, and where a neighbour lies in front; the nearest solution wins. So a silhouette is where
// the surface ends, and a crack between grids of different fineness cannot show.

layout(local_size_x = 64) in;

// A solution may lie this many sub-patches away from its guess.
const int PATCHES = 4;
// Newton's method that is still so far from the ray inside a sub-patch will not meet it there.
const float STUCK_PX = 0.5;

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

// The node and its coordinates where a step from `xy` leads, over borders if need be. False where it
// leads into a hole.
bool walk(inout Node node, inout vec2 xy)
{
    if (all(greaterThanEqual(xy, vec2(0.0))) && all(lessThanEqual(xy, vec2(1.0))))
        return true;
    Place place = place_of(node, xy);
    settle(place);
    node_under(place, node, xy);
    return node.kind != HOLE;
}

// From the guess that pixel q has to the place on the ray; not found when there is none near.
//
// A sub-patch is fetched and projected once and left only when Newton's method has settled in it or
// runs out of it: what it says of a place beyond its border is a guess for the next.
Solution solve(ivec2 q, uvec2 guess, Ray r)
{
    Solution result;
    result.found = false;
    Node node = node_load(guess.x);
    vec2 xy = guess_xy(node, guess.y);
    float px = pixel_units(depth_of(texelFetch(seen_depth, q, 0).x));
    for (int i = 0; i < PATCHES; i++) {
        Net points;
        float scale;
        mat3 frame = frame_of(node);
        SubPatch own = sub_patch_at(node, xy);
        fetch_points(own, points, scale);
        vec2 st = own.st;
        float residual = solve_patch(project(node, frame, points, scale, r), scale / px, st);
        bool inside = all(greaterThanEqual(st, vec2(0.0))) && all(lessThanEqual(st, vec2(1.0)));
        // Where the ray touches the surface, steps get shorter slowly; where it passes by, they do not.
        bool settled = inside && (residual < close_enough(scale / px) || residual > STUCK_PX);
        if (settled || own.limit || i == PATCHES - 1) {
            Surface s = own.limit ? limit_of(node, frame, scale)
                                  : patch_at(node, frame, points, scale, st);
            float off = length(s.s.xy - r.start - r.slope * s.s.z) / pixel_units(s.s.z);
            bool is_near = off < 4.0 * close_enough(scale / pixel_units(s.s.z)) && s.s.z > 0.0;
            result.found = own.limit ? meet_limit(node, r, s) : is_near && inside;
            result.hit = Hit(node, ldexp(own.origin + st, -own.scale), own.scale, s);
            break;
        }
        xy = ldexp(own.origin + st, -own.scale);
        if (!walk(node, xy))
            break;
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
        Solution other = solve(q, guess, r);
        if (other.found && (!best.found || other.hit.surface.s.z < best.hit.surface.s.z))
            best = other;
    }
    if (best.found)
        store_hit(p, best.hit.node, best.hit.xy, best.hit.steps, best.hit.surface);
    else
        store_miss(p);
}
