// Finds, for a surface point, the ray of the line family, where it meets the light, and how both change over the
// pixel (server/surface/README.md 7.2; Igehy 1999). The including program defines FAMILY and LIGHT. Where these are
// constants, a compiler drops what other families and lights need.

#define REFLECTION 0
#define HIGHLIGHT 1
#define ISOPHOTE 2
#define ZEBRA 3
#define ENVIRONMENT 4

#define RECTANGLE 0
#define PLANE 1
#define TUNNEL 2
#define SPHERE 3

layout(std140, binding = 1) uniform Light {
    vec4 line_eye;  // relative to the camera's eye, world axes; w = 0: a unit direction of view
    // The camera's eye relative to the light's centre, computed by the caller in double precision, so that single
    // precision never has to cancel large numbers. Rectangle and plane: the eye's coordinates q, and its height over
    // the plane. Tunnel: its coordinates along axis_u, axis_v, axis_n; w: radius^2 less its squared distance from the
    // axis.
    vec4 origin;
    // Rectangle and plane: unit u x v, and the dual basis: q = size * (dual . (x - centre)). Otherwise: the unit axis
    // (w: the tunnel's radius), the direction of azimuth 0, and the direction a quarter turn later.
    vec4 axis_n, axis_u, axis_v;
    vec4 size;                         // width, height of the light
    vec4 foreground, background, miss, empty, base;  // linear, premultiplied by alpha
    vec4 turn;                         // cosine and sine of the rotation; 1 / period; offset
    vec4 wave;                         // phases at the centre along both ways; duty; soft
    vec4 single[4];                    // positions of single lines, from the centre
    float opacity, half_width;
    int n_single;
    bool is_hindmost, is_foremost, is_one_sided, has_direction;
    ivec4 want;                        // whether to write light_st, curvature, light_change; whether to list parts
};

const float PI = 3.14159265358979;

// What counts as 0 in single precision: a sum of products whose share of the products' sizes is at most ROUNDING, and
// a sine of at most LEAST_SINE between a computed unit vector and a plane or an axis. README.md, "Where rounding
// decides", says what is shown in these cases.
const float ROUNDING = 1.0 / 2097152.0, LEAST_SINE = 1e-6;

struct Sample {
    vec3 x, n, h;  // place relative to the eye, unit normal, shape operator
    vec3 v;        // unit view direction of the line eye
    vec3 dx[2], dn[2], dv[2];  // change by a pixel to the right and by a pixel down
};

// What the pattern is given.
struct Met {
    vec2 q;        // coordinates on the light from its centre, in its units
    vec2 ds, dt;   // change of q.x and of q.y by a pixel to the right and down
    float tau;     // length of the ray
    vec2 dtau;
    float cover;   // how much of the pixel falls on the light
    bool inside;   // whether the pixel's centre meets the light
};

// -dN along a tangent vector, from the shape operator.
vec3 normal_change(vec3 along, vec3 n, vec3 h)
{
    vec3 e1, e2;
    tangent_basis(n, e1, e2);
    vec2 a = vec2(dot(along, e1), dot(along, e2));
    return -(e1 * (h.x * a.x + h.y * a.y) + e2 * (h.y * a.x + h.z * a.y));
}

// The error of the distance of x from the line eye in single precision.
float eye_noise(vec3 x)
{
    return ROUNDING * (length(x) + length(line_eye.xyz));
}

// Steps 1 to 3 of server/surface/README.md 7.2, at depth z on the ray of q (view.glsl), over the parallelogram of the
// columns of `sides`, px. The shape operator h belongs to h_normal, a normal nearby.
Sample sample_over(vec2 q, mat2 sides, float z, vec3 n, vec3 h, vec3 h_normal)
{
    Sample at;
    at.x = on_ray(q, z);
    at.n = n;
    at.h = h;
    vec3 d = to_world(vec3(q * ray.x, 1.0));
    vec3 from_eye = at.x - line_eye.xyz;
    float distance = line_eye.w > 0.0 ? length(from_eye) : 1.0;
    bool is_at_eye = line_eye.w > 0.0 && distance <= eye_noise(at.x);
    at.v = is_at_eye ? -n : line_eye.w > 0.0 ? from_eye / distance : line_eye.xyz;
    for (int i = 0; i < 2; i++) {
        vec3 raw = (axis[0].xyz * sides[i].x + axis[1].xyz * sides[i].y) * pixel_units(z);
        at.dx[i] = raw - d * (dot(raw, n) / dot(d, n));
        at.dn[i] = normal_change(at.dx[i], h_normal, h);
        at.dv[i] = is_at_eye ? -at.dn[i]
                             : line_eye.w / distance * (at.dx[i] - at.v * dot(at.v, at.dx[i]));
    }
    return at;
}

// The same over a square of side size_px.
Sample sample_at(vec2 q, float size_px, float z, vec3 n, vec3 h, vec3 h_normal)
{
    return sample_over(q, mat2(size_px), z, n, h, h_normal);
}

// Step 4: the family's ray and its change.
void ray_from(Sample at, out vec3 r, out vec3 dr[2])
{
    if (FAMILY == HIGHLIGHT) {
        float distance = length(at.x - line_eye.xyz);
        float noise = line_eye.w > 0.0 ? eye_noise(at.x) / distance : 0.0;
        float side = dot(at.n, at.v) < max(noise, LEAST_SINE) ? 1.0 : -1.0;
        r = side * at.n;
        for (int i = 0; i < 2; i++)
            dr[i] = side * at.dn[i];
        return;
    }
    float approach = dot(at.v, at.n);
    r = at.v - 2.0 * approach * at.n;
    for (int i = 0; i < 2; i++)
        dr[i] = at.dv[i] -
                2.0 * ((dot(at.dv[i], at.n) + dot(at.v, at.dn[i])) * at.n + approach * at.dn[i]);
}

// atan(y, x) to the last digits of single precision; a device's own function may be far less exact. Not both
// arguments may be 0. The polynomial is (atan(t) / t - 1) / t^2 in z = t^2, interpolated at Chebyshev's nodes for |t|
// <= tan(pi / 8); larger t are reduced to that range by pi / 4 and pi / 2.
float angle_of(float y, float x)
{
    float low = min(abs(x), abs(y)), high = max(abs(x), abs(y));
    bool is_steep = low > 0.41421356 * high;
    float t = is_steep ? (low - high) / (low + high) : low / high, z = t * t;
    float p = -0.33333332 + z * (0.19999540 + z * (-0.14263954 + z * (0.10743719 - z * 0.06451886)));
    float angle = (is_steep ? 0.25 * PI : 0.0) + (t + t * (z * p));
    angle = abs(y) > abs(x) ? 0.5 * PI - angle : angle;
    angle = x < 0.0 ? PI - angle : angle;
    return y < 0.0 ? -angle : angle;
}

struct Angles {
    float azimuth, elevation;  // about axis_n, radians
    vec2 d_azimuth, d_elevation;
};

Angles angles_of(vec3 r, vec3 dr[2])
{
    Angles a;
    float x = dot(r, axis_u.xyz), y = dot(r, axis_v.xyz), z = dot(r, axis_n.xyz);
    bool at_pole = x * x + y * y < LEAST_SINE * LEAST_SINE;
    a.azimuth = at_pole ? 0.0 : angle_of(y, x);
    a.elevation = angle_of(z, length(vec2(x, y)));
    float flat2 = max(x * x + y * y, LEAST_SINE * LEAST_SINE), level = sqrt(flat2);
    for (int i = 0; i < 2; i++) {
        float dx = dot(dr[i], axis_u.xyz), dy = dot(dr[i], axis_v.xyz), dz = dot(dr[i], axis_n.xyz);
        a.d_azimuth[i] = (x * dy - y * dx) / flat2;
        a.d_elevation[i] = dz / level;
    }
    return a;
}

// Where the ray turns by more than this over the pixel (rad), as close to a silhouette, it does not turn in
// proportion to the place in the pixel. Then the pixel's centre alone decides whether the light is met.
const float MOST_TURN_OF_RAY = 0.5;

// Share of the pixel that falls on the rectangle, on the side of the plane where the ray's approach times `side` is
// positive. The place that the ray meets is a quotient, far from linear over the pixel where the ray is nearly
// parallel to the light's plane. Numerator and denominator are linear, so each of the rectangle's four borders is a
// straight line through the pixel, however thin the light. (A place inside all four borders also lies ahead on the
// ray.)
float rectangle_share(Sample at, vec3 r, vec3 dr[2], float ahead, float side)
{
    vec3 m = axis_n.xyz;
    float approach = side * dot(m, r);
    vec2 over, d_approach, d_over[2];
    for (int k = 0; k < 2; k++) {
        vec3 e = k == 0 ? axis_u.xyz : axis_v.xyz;
        float from = origin[k] / size[k] + dot(e, at.x), along = side * dot(e, r);
        over[k] = from * approach + along * ahead;
        for (int i = 0; i < 2; i++) {
            d_approach[i] = side * dot(m, dr[i]);
            d_over[k][i] = dot(e, at.dx[i]) * approach + from * d_approach[i] +
                           side * dot(e, dr[i]) * ahead - along * dot(m, at.dx[i]);
        }
    }
    Border border[4];
    for (int k = 0; k < 4; k++) {
        float sign = (k & 1) == 0 ? 1.0 : -1.0;
        border[k] = Border(0.5 * approach + sign * over[k >> 1], 0.5 * d_approach + sign * d_over[k >> 1]);
    }
    return share_within(border);
}

const Met NOT_MET = Met(vec2(0.0), vec2(0.0), vec2(0.0), 0.0, vec2(0.0), 0.0, false);

// Step 5: where x + tau r meets the light's plane, and how that changes. A ray along the plane does not meet it, nor
// does one that starts in it.
Met meet_plane(Sample at, vec3 r, vec3 dr[2])
{
    Met met;
    vec3 m = axis_n.xyz;
    float approach = dot(m, r), ahead = -origin.z - dot(m, at.x);
    if (abs(ahead) <= ROUNDING * (abs(origin.z) + length(at.x)))
        ahead = 0.0;
    float towards = approach * sign(ahead) - LEAST_SINE;
    approach = approach < 0.0 ? min(approach, -LEAST_SINE) : max(approach, LEAST_SINE);
    float tau = ahead / approach;
    vec3 y = at.x + tau * r;
    met.q = origin.xy + size.xy * vec2(dot(axis_u.xyz, y), dot(axis_v.xyz, y));
    vec2 d_approach;
    for (int i = 0; i < 2; i++) {
        d_approach[i] = dot(m, dr[i]);
        met.dtau[i] = -(dot(m, at.dx[i]) + tau * d_approach[i]) / approach;
        vec3 dy = at.dx[i] + tau * dr[i] + r * met.dtau[i];
        met.ds[i] = size.x * dot(axis_u.xyz, dy);
        met.dt[i] = size.y * dot(axis_v.xyz, dy);
    }
    bool faces = !is_one_sided || ahead < 0.0;
    met.inside = faces && (FAMILY == HIGHLIGHT ? abs(approach) > LEAST_SINE : towards > 0.0);
    if (LIGHT == RECTANGLE && FAMILY == HIGHLIGHT)
        met.cover = faces ? rectangle_share(at, r, dr, ahead, 1.0) + rectangle_share(at, r, dr, ahead, -1.0) : 0.0;
    else if (LIGHT == RECTANGLE)
        met.cover = faces && ahead != 0.0 ? rectangle_share(at, r, dr, ahead, sign(ahead)) : 0.0;
    else if (FAMILY == HIGHLIGHT)
        met.cover = met.inside ? 1.0 : 0.0;
    else
        met.cover = faces && ahead != 0.0 ? half_plane(towards, d_approach) : 0.0;
    if (LIGHT == RECTANGLE) {
        met.inside = met.inside && max(abs(met.q.x / size.x), abs(met.q.y / size.y)) <= 0.5;
        if (max(dot(dr[0], dr[0]), dot(dr[1], dr[1])) > MOST_TURN_OF_RAY * MOST_TURN_OF_RAY)
            met.cover = met.inside ? 1.0 : 0.0;
    }
    met.dtau *= sign(tau);
    met.tau = abs(tau);
    return met;
}

// In the plane across the axis.
vec2 across_axis(vec3 v)
{
    return vec2(dot(axis_u.xyz, v), dot(axis_v.xyz, v));
}

// Where the ray meets the far side of the cylinder, which is its inside for an object in the tunnel. In the plane
// perpendicular to the axis the ray is a line that passes the axis at the distance `pass`; it is inside the circle
// for `half_chord` on either side of the point nearest to the axis. A ray along the axis meets nothing.
Met meet_tunnel(Sample at, vec3 r, vec3 dr[2])
{
    Met met;
    float radius = axis_n.w;
    vec2 x = across_axis(at.x), from = origin.xy + x, across = across_axis(r);
    float sine = length(across), away = length(from);
    if (sine < LEAST_SINE)
        return NOT_MET;
    vec2 along = across / sine;
    float pass = along.x * from.y - along.y * from.x, gone = dot(from, along);
    // radius^2 - away^2. It is computed from the eye's value where the eye is no farther from the axis than x inside
    // the tunnel can be: then the distance of x from the wall of a wide tunnel is exact. half_chord^2 follows from it
    // where no larger squares cancel.
    bool is_eye_near = abs(origin.w) < 3.0 * radius * radius;
    float power = is_eye_near ? origin.w - dot(x, origin.xy + from) : (radius - away) * (radius + away);
    bool is_near = away < (is_eye_near ? 2.0 : 1.0) * radius;
    float chord2 = is_near ? gone * gone + power : (radius - abs(pass)) * (radius + abs(pass));
    float half_chord = sqrt(max(chord2, 0.0));
    // The far one of the two intersections, which is half_chord - gone from x.
    met.tau = (gone > 0.0 ? power / (half_chord + gone) : half_chord - gone) / sine;
    if (!(chord2 > 0.0 && met.tau > 0.0))
        return NOT_MET;
    vec2 y = half_chord * along + pass * vec2(-along.y, along.x);
    for (int i = 0; i < 2; i++) {
        vec3 change = at.dx[i] + met.tau * dr[i];
        met.dtau[i] = -dot(y, across_axis(change)) / (half_chord * sine);
        vec3 dy = change + r * met.dtau[i];
        vec2 d = across_axis(dy);
        met.ds[i] = (y.x * d.y - y.y * d.x) / radius;
        met.dt[i] = dot(axis_n.xyz, dy);
    }
    met.q = vec2(radius * angle_of(y.y, y.x),
                 origin.z + (dot(axis_n.xyz, at.x) + met.tau * dot(axis_n.xyz, r)));
    met.inside = true;
    met.cover = 1.0;
    return met;
}

// A light at infinity is met by direction alone; q is in degrees.
Met meet_infinity(vec2 q, vec2 ds, vec2 dt)
{
    const float degrees = 180.0 / PI;
    return Met(q * degrees, ds * degrees, dt * degrees, 0.0, vec2(0.0), 1.0, true);
}

Met meet_isophote(Sample at)
{
    vec3 d = has_direction ? axis_n.xyz : -at.v;
    vec3 e = cross(at.n, d);
    float sine = length(e), cosine = dot(at.n, d);
    vec2 ds;
    for (int i = 0; i < 2; i++)
        ds[i] = -(dot(at.dn[i], d) - (has_direction ? 0.0 : dot(at.n, at.dv[i]))) / max(sine, LEAST_SINE);
    return meet_infinity(vec2(angle_of(sine, cosine) - 0.5 * PI, 0.0), ds, vec2(0.0));
}

Met meet(Sample at)
{
    if (FAMILY == ISOPHOTE)
        return meet_isophote(at);
    vec3 r, dr[2];
    ray_from(at, r, dr);
    if (FAMILY == ZEBRA) {
        Angles a = angles_of(r, dr);
        return meet_infinity(vec2(a.elevation, a.azimuth), a.d_elevation, a.d_azimuth);
    }
    if (FAMILY == ENVIRONMENT) {
        Angles a = angles_of(r, dr);
        return meet_infinity(vec2(-a.azimuth, a.elevation), -a.d_azimuth, a.d_elevation);
    }
    if (LIGHT == SPHERE) {
        Angles a = angles_of(r, dr);
        return meet_infinity(vec2(a.azimuth, a.elevation), a.d_azimuth, a.d_elevation);
    }
    if (LIGHT == TUNNEL)
        return meet_tunnel(at, r, dr);
    return meet_plane(at, r, dr);
}
