// Newton's method across the borders of sub-patches, nodes and faces, for the passes of stage 2 over listed pixels.

// Number of sub-patches tried on the way, and how many sub-patches far the tangent plane of one may lead.
const int PATCHES = 4;
const float MOST_SUB_PATCHES = 16.0;
// If Newton's method is still this far from the ray inside a sub-patch, it will not meet the ray there.
const float STUCK_PX = 0.5;

struct Hit {
    Node node;
    vec2 xy;
    ivec2 steps;  // the surface's parameters grow 2^steps times as fast as xy
    Surface surface;
};

// A place on the surface near a ray, packed as by visibility.frag.glsl, and its depth.
struct Guess {
    uint node, where;
    float depth;
};

struct Solution {
    bool found;
    Hit hit;
};

// Inside the last ring of an extraordinary vertex (2^-32 of the node) the surface counts as its tangent plane there;
// at a cone's tip, as a plane perpendicular to the view. Returns whether the ray meets it.
bool meet_limit(Node node, Ray r, inout Surface s)
{
    vec3 o = vec3(r.start, 0.0), d = vec3(r.slope, 1.0);
    vec3 n = dot(s.n, s.n) > 0.0 ? s.n : vec3(0.0, 0.0, 1.0);
    float z = dot(n, node.origin - o) / dot(n, d);
    s.s = o + z * d;
    return z > 0.0 && distance(s.s, node.origin) < 2.0 * s.scale;
}

// Moves to the node and coordinates that a step to `xy` leads to, across borders if need be. False if it leads into a
// hole.
bool walk(inout Node node, inout vec2 xy)
{
    if (all(greaterThanEqual(xy, vec2(0.0))) && all(lessThanEqual(xy, vec2(1.0))))
        return true;
    Place place = place_of(node, xy);
    settle(place);
    node_under(place, node, xy);
    return node.kind != HOLE;
}

Guess guess_of(ivec2 pixel)
{
    uvec2 guess = texelFetch(seen, pixel, 0).xy;
    return Guess(guess.x == UNSEEN ? UNSEEN : guess.x & ~IN_GAP, guess.y,
                 depth_of(texelFetch(seen_depth, pixel, 0).x));
}

// From a guess to the place on the ray; not found if there is no guess, or no place near it.
//
// A sub-patch is fetched and projected once, and left only when Newton's method has settled in it or leaves it: then
// the step from the border gives the guess for the next sub-patch.
Solution solve_from(Node node, vec2 xy, float depth, Ray r)
{
    Solution result;
    result.found = false;
    float px = pixel_units(depth);
    for (int i = 0; i < PATCHES; i++) {
        Net points;
        float scale;
        mat3 frame = frame_of(node);
        SubPatch own = sub_patch_at(node, xy);
        fetch_points(own, points, scale);
        FlatNet net = project(node, frame, points, scale, r);
        vec2 st = own.st;
        float residual = solve_patch(net, scale / px, st);
        bool inside = all(greaterThanEqual(st, vec2(0.0))) && all(lessThanEqual(st, vec2(1.0)));
        // Where the ray touches the surface, steps shrink slowly; where it passes by, they do not shrink.
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
        // The tangent plane at the border leads on, across many sub-patches where they are small.
        vec2 onwards;
        st = clamp(st, 0.0, 1.0);
        newton_step(net, st, MOST_SUB_PATCHES, onwards);
        xy = ldexp(own.origin + st + onwards, -own.scale);
        if (!walk(node, xy))
            break;
    }
    return result;
}

Solution solve(Guess guess, Ray r)
{
    Solution result;
    result.found = false;
    if (guess.node == UNSEEN)
        return result;
    Node node = node_load(guess.node);
    return solve_from(node, guess_xy(node, guess.where), guess.depth, r);
}
