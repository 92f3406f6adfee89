// From a surface point to the light: the ray of the line family, where it meets the light, and how
// both change over the pixel (limit-surface 5.1; Igehy 1999).
//
// Defined before this file: FAMILY, LIGHT.

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
    vec4 line_eye;  // relative to the camera's, world axes; w = 0: a unit direction of view
    vec4 centre;    // relative to the eye, world axes
    // Rectangle and plane: u x v, unit, and the dual basis: q = size * (dual . (x - centre)).
    // Else the axis, unit, w: the tunnel's radius; and where azimuth begins, and a quarter later.
    vec4 axis_n, axis_u, axis_v;
    vec4 size;                         // width, height of the light
    vec4 foreground, background, miss, empty, base;  // linear, premultiplied by alpha
    vec4 turn;                         // cosine and sine of the rotation; 1 / period; offset
    vec4 wave;                         // phases at the centre along both ways; duty; soft
    vec4 single[4];                    // places of single lines, from the centre
    float opacity, half_width;
    int n_single;
    bool is_hindmost, is_foremost, is_one_sided, has_direction;
    ivec4 want;                        // whether to write light_st, curvature, light_change
};

const float PI = 3.14159265358979;

struct Sample {
    vec3 x, n, h;  // place relative to the eye, unit normal, shape operator
    vec3 v;        // unit view direction of the line eye
    vec3 dx[2], dn[2], dv[2];  // by a pixel to the right and a pixel down
};

// What the pattern gets to know.
struct Met {
    vec2 q;        // coordinates on the light from its centre, in its units
    vec2 ds, dt;   // change of q.x and of q.y by a pixel to the right and down
    float tau;     // length of the ray
    vec2 dtau;
    float cover;   // how much of the pixel falls on the light
    bool inside;   // its centre does
};

// -dN along a tangent vector, by the shape operator.
vec3 normal_change(vec3 along, vec3 n, vec3 h)
{
    vec3 e1, e2;
    tangent_basis(n, e1, e2);
    vec2 a = vec2(dot(along, e1), dot(along, e2));
    return -(e1 * (h.x * a.x + h.y * a.y) + e2 * (h.y * a.x + h.z * a.y));
}

// Steps (1) to (4) of limit-surface 5.1, at depth z on the ray of q (view.glsl), over the parallelogram
// of the columns of `sides`, px. The shape operator is that at a normal nearby.
Sample sample_over(vec2 q, mat2 sides, float z, vec3 n, vec3 h, vec3 h_normal)
{
    Sample at;
    at.x = on_ray(q, z);
    at.n = n;
    at.h = h;
    vec3 d = to_world(vec3(q * ray.x, 1.0));
    vec3 from_eye = at.x - line_eye.xyz;
    float distance = line_eye.w > 0.0 ? length(from_eye) : 1.0;
    at.v = line_eye.w > 0.0 ? from_eye / distance : line_eye.xyz;
    for (int i = 0; i < 2; i++) {
        vec3 raw = (axis[0].xyz * sides[i].x + axis[1].xyz * sides[i].y) * pixel_units(z);
        at.dx[i] = raw - d * (dot(raw, n) / dot(d, n));
        at.dn[i] = normal_change(at.dx[i], h_normal, h);
        at.dv[i] = line_eye.w / distance * (at.dx[i] - at.v * dot(at.v, at.dx[i]));
    }
    return at;
}

// Over a square of size_px.
Sample sample_at(vec2 q, float size_px, float z, vec3 n, vec3 h, vec3 h_normal)
{
    return sample_over(q, mat2(size_px), z, n, h, h_normal);
}

// The family's ray and its change: step (5).
void ray_from(Sample at, out vec3 r, out vec3 dr[2])
{
#if FAMILY == HIGHLIGHT
    float side = dot(at.n, at.v) < 0.0 ? 1.0 : -1.0;
    r = side * at.n;
    for (int i = 0; i < 2; i++)
        dr[i] = side * at.dn[i];
#else
    float approach = dot(at.v, at.n);
    r = at.v - 2.0 * approach * at.n;
    for (int i = 0; i < 2; i++)
        dr[i] = at.dv[i] -
                2.0 * ((dot(at.dv[i], at.n) + dot(at.v, at.dn[i])) * at.n + approach * at.dn[i]);
#endif
}

struct Angles {
    float azimuth, elevation;  // about axis_n, radians
    vec2 d_azimuth, d_elevation;
};

Angles angles_of(vec3 r, vec3 dr[2])
{
    Angles a;
    float x = dot(r, axis_u.xyz), y = dot(r, axis_v.xyz), z = dot(r, axis_n.xyz);
    float flat2 = max(x * x + y * y, 1e-24), level = sqrt(flat2);
    a.azimuth = atan(y, x);
    a.elevation = atan(z, level);
    for (int i = 0; i < 2; i++) {
        float dx = dot(dr[i], axis_u.xyz), dy = dot(dr[i], axis_v.xyz), dz = dot(dr[i], axis_n.xyz);
        a.d_azimuth[i] = (x * dy - y * dx) / flat2;
        a.d_elevation[i] = dz / level;
    }
    return a;
}

// How much of the pixel falls on the rectangle. Where the footprint spans all of it, it is no longer
// linear (the ray runs along the light's plane): the pixel's centre decides, as it does for no
// footprint at all.
float rectangle_cover(Met met)
{
    vec2 st = met.q / size.xy, gs = met.ds / size.x, gt = met.dt / size.y;
    vec2 reach = vec2(abs(gs.x) + abs(gs.y), abs(gt.x) + abs(gt.y));
    if (max(reach.x, reach.y) > 1.0 || min(reach.x, reach.y) <= 0.0)
        return max(abs(st.x), abs(st.y)) <= 0.5 ? 1.0 : 0.0;
    return box_share(-0.5 - st, 0.5 - st, gs, gt);
}

// Step (6): where x + tau r meets the light's plane, and its change.
Met meet_plane(Sample at, vec3 r, vec3 dr[2])
{
    Met met;
    vec3 m = axis_n.xyz;
    float approach = dot(m, r), ahead = dot(m, centre.xyz - at.x), tau = ahead / approach;
    vec3 y = at.x + tau * r - centre.xyz;
    met.q = size.xy * vec2(dot(axis_u.xyz, y), dot(axis_v.xyz, y));
    vec2 d_approach;
    for (int i = 0; i < 2; i++) {
        d_approach[i] = dot(m, dr[i]);
        met.dtau[i] = -(dot(m, at.dx[i]) + tau * d_approach[i]) / approach;
        vec3 dy = at.dx[i] + tau * dr[i] + r * met.dtau[i];
        met.ds[i] = size.x * dot(axis_u.xyz, dy);
        met.dt[i] = size.y * dot(axis_v.xyz, dy);
    }
    bool faces = !is_one_sided || ahead < 0.0;
#if FAMILY == HIGHLIGHT
    met.cover = faces && abs(approach) > 0.0 ? 1.0 : 0.0;
#elif LIGHT == PLANE
    met.cover = faces ? half_plane(approach * sign(ahead), d_approach) : 0.0;
#else
    met.cover = faces && tau > 0.0 ? 1.0 : 0.0;
#endif
    met.inside = faces && (FAMILY == HIGHLIGHT || tau > 0.0);
#if LIGHT == RECTANGLE
    met.inside = met.inside && max(abs(met.q.x / size.x), abs(met.q.y / size.y)) <= 0.5;
    met.cover *= rectangle_cover(met);
#endif
    met.dtau *= sign(tau);
    met.tau = abs(tau);
    return met;
}

// A ray that runs along the tunnel meets nothing: the sine, squared, that single precision tells from 0.
const float LEAST_ACROSS = 1e-12;

// The far side of the cylinder: its inside, for what stands in the tunnel.
Met meet_tunnel(Sample at, vec3 r, vec3 dr[2])
{
    Met met;
    vec3 a = axis_n.xyz, from = at.x - centre.xyz;
    float radius = axis_n.w;
    vec3 x = from - a * dot(a, from), across = r - a * dot(a, r);
    float rr = dot(across, across), xr = dot(x, across);
    if (rr < LEAST_ACROSS)
        return Met(vec2(0.0), vec2(0.0), vec2(0.0), 0.0, vec2(0.0), 0.0, false);
    float inside = xr * xr - rr * (dot(x, x) - radius * radius);
    met.tau = (sqrt(max(inside, 0.0)) - xr) / rr;
    vec3 y = x + met.tau * across;
    vec3 along = from + met.tau * r;
    float yr = dot(y, across);
    for (int i = 0; i < 2; i++) {
        vec3 change = at.dx[i] + met.tau * dr[i];
        met.dtau[i] = -dot(y, change) / yr;
        vec3 dy = change + r * met.dtau[i];
        met.ds[i] = (dot(y, axis_u.xyz) * dot(dy, axis_v.xyz) -
                     dot(y, axis_v.xyz) * dot(dy, axis_u.xyz)) / radius;
        met.dt[i] = dot(dy, a);
    }
    met.q = vec2(radius * atan(dot(y, axis_v.xyz), dot(y, axis_u.xyz)), dot(along, a));
    met.inside = inside > 0.0 && met.tau > 0.0;
    met.cover = met.inside ? 1.0 : 0.0;
    return met;
}

// What is at infinity is met by direction alone; q in degrees.
Met meet_infinity(vec2 q, vec2 ds, vec2 dt)
{
    const float degrees = 180.0 / PI;
    return Met(q * degrees, ds * degrees, dt * degrees, 0.0, vec2(0.0), 1.0, true);
}

Met meet(Sample at)
{
#if FAMILY == ISOPHOTE
    vec3 d = has_direction ? axis_n.xyz : -at.v;
    vec3 e = cross(at.n, d);
    float sine = max(length(e), 1e-12), cosine = dot(at.n, d);
    vec2 ds;
    for (int i = 0; i < 2; i++)
        ds[i] = -(dot(at.dn[i], d) - (has_direction ? 0.0 : dot(at.n, at.dv[i]))) / sine;
    return meet_infinity(vec2(atan(sine, cosine) - 0.5 * PI, 0.0), ds, vec2(0.0));
#else
    vec3 r, dr[2];
    ray_from(at, r, dr);
#if FAMILY == ZEBRA
    Angles a = angles_of(r, dr);
    return meet_infinity(vec2(a.elevation, a.azimuth), a.d_elevation, a.d_azimuth);
#elif FAMILY == ENVIRONMENT
    Angles a = angles_of(r, dr);
    return meet_infinity(vec2(-a.azimuth, a.elevation), -a.d_azimuth, a.d_elevation);
#elif LIGHT == SPHERE
    Angles a = angles_of(r, dr);
    return meet_infinity(vec2(a.azimuth, a.elevation), a.d_azimuth, a.d_elevation);
#elif LIGHT == TUNNEL
    return meet_tunnel(at, r, dr);
#else
    return meet_plane(at, r, dr);
#endif
#endif
}
