// The pixel's ray as the intersection of two planes, and Newton's method on the distances from them
// (server/surface/README.md 7.1): f(s,t) = 0 where the surface meets the ray. Distances are measured in the patch's
// own frame and scale, so a patch is projected only once, to a net of 2-D points, and each step is cheap.

struct Ray {
    vec2 slope;  // camera space: the ray is (start, 0) + z (slope, 1)
    vec2 start;
};

Ray ray_through(vec2 q)  // view.glsl
{
    return Ray(q * ray.x, q * ray.y);
}

Ray ray_of(ivec2 pixel)
{
    return ray_through(pixel_offset(pixel));
}

// Distances of the 16 points from the two planes, in units of scale, as rows like those of a Net.
struct FlatNet {
    vec4 x[4], y[4];
};

FlatNet project(Node node, mat3 frame, Net p, float scale, Ray r)
{
    vec3 h = vec3(1.0, 0.0, -r.slope.x) * frame, k = vec3(0.0, 1.0, -r.slope.y) * frame;
    vec2 at = (node.origin.xy - r.start - r.slope * node.origin.z) / scale;
    FlatNet net;
    for (int j = 0; j < 4; j++) {
        net.x[j] = at.x + (h.x * p.x[j] + h.y * p.y[j] + h.z * p.z[j]);
        net.y[j] = at.y + (k.x * p.x[j] + k.y * p.y[j] + k.z * p.z[j]);
    }
    return net;
}

// One step from st, limited to `most` sub-patches; returns f at st. Where the ray touches the surface (no inverse)
// the step is 0.
vec2 newton_step(FlatNet net, vec2 st, float most, out vec2 step_st)
{
    vec4 bu, bv;
    vec3 du, dv;
    blends(st.x, bu, du);
    blends(st.y, bv, dv);
    vec2 f = vec2(0.0), fu = vec2(0.0), c[4];
    for (int j = 0; j < 4; j++) {
        vec4 x = net.x[j], y = net.y[j];
        c[j] = vec2(dot(bu, x), dot(bu, y));
        f += bv[j] * c[j];
        fu += bv[j] * vec2(dot(du, x.yzw - x.xyz), dot(du, y.yzw - y.xyz));
    }
    vec2 fv = dv.x * (c[1] - c[0]) + dv.y * (c[2] - c[1]) + dv.z * (c[3] - c[2]);
    float det = fu.x * fv.y - fu.y * fv.x;
    bool touches = !(abs(det) > 1e-7 * (dot(fu, fu) + dot(fv, fv)));
    step_st = vec2(f.y * fv.x - f.x * fv.y, f.x * fu.y - f.y * fu.x) / (touches ? 1.0 : det);
    float longest = max(abs(step_st.x), abs(step_st.y));
    step_st *= touches ? 0.0 : min(1.0, most / max(longest, 1e-30));
    return f;
}

// A place counts as on the ray up to this distance, px: far below what a pixel can show, except for a patch so much
// larger than a pixel that single precision cannot resolve it.
float close_enough(float px_per_scale)
{
    return max(0.0005, 1.5e-7 * px_per_scale);
}

// Newton's method inside one sub-patch, whose polynomials hold a little beyond its border too. Returns the distance
// of the surface from the ray before the last step, px. The last step squares that distance, so a result that is
// close enough means that st lies on the ray; the exception is a place so near the border that the step leaves the
// sub-patch, which then stays where it is.
float solve_patch(FlatNet net, float px_per_scale, inout vec2 st)
{
    float residual = 1e30, enough = close_enough(px_per_scale);
    for (int i = 0; i < 5; i++) {
        vec2 step_st;
        // Farther than half a sub-patch the linear model tells little.
        residual = length(newton_step(net, st, 0.5, step_st)) * px_per_scale;
        vec2 next = st + step_st;
        bool leaves = any(lessThan(next, vec2(0.0))) || any(greaterThan(next, vec2(1.0)));
        st = residual < enough && leaves ? st : next;
        if (residual < enough)
            break;
        if (any(lessThan(st, vec2(-0.5))) || any(greaterThan(st, vec2(1.5))))
            break;
    }
    return residual;
}

// The visibility buffer's guess, as local coordinates of its node.
vec2 guess_xy(Node node, uint packed_guess)
{
    vec2 st = vec2(packed_guess >> 6 & 8191u, packed_guess >> 19) * (2.0 / 8191.0);
    return clamp(ldexp(st, -level_scale(node, int(packed_guess & 63u))), 0.0, 1.0);
}
