// Stage 3, shade: the view ray reflected at (P, N), met with the plane of the light, and what the
// light shows there, averaged over the pixel.
//
// The pixel's footprint on the light is the exact Jacobian of that map: ray differentials (Igehy
// 1999) with the normal's derivative from the surface's own shape operator (limit-surface 5.1).
// Light, pattern and colours may change without stages 1 and 2.

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) readonly uniform image2D position;
layout(binding = 1, rgba32f) readonly uniform image2D normal;
layout(binding = 2, rg32f) readonly uniform image2D shape;
layout(binding = 3, rgba8) writeonly uniform image2D colour;
layout(binding = 4, rg32f) writeonly uniform image2D light_st;
layout(binding = 5, rg32f) writeonly uniform image2D curvature;

layout(binding = 0) uniform sampler2D picture;

layout(std140, binding = 1) uniform Light {
    vec4 centre;      // relative to the eye, world axes
    vec4 normal_uv;   // u x v
    vec4 dual_u;      // s - 1/2 = dual_u . (x - centre)
    vec4 dual_v;
    vec4 size;        // |u|, |v|
    vec4 foreground, background, miss, empty;
    vec4 pattern;     // count, duty
    ivec4 want;           // whether to write light_st, curvature
};

uniform uint n_blocks;

// PATTERN is defined before this file: a program for each kind, since some devices walk through
// every branch.
#define STRIPES 0
#define LATTICE 1
#define CIRCLES 2
#define IMAGE 3


// -dN along a tangent vector, by the shape operator.
vec3 normal_change(vec3 along, vec3 n, vec3 h)
{
    vec3 e1, e2;
    tangent_basis(n, e1, e2);
    vec2 a = vec2(dot(along, e1), dot(along, e2));
    return -(e1 * (h.x * a.x + h.y * a.y) + e2 * (h.y * a.x + h.z * a.y));
}

// Steps (1) to (5) of limit-surface 5.1 for one image axis: the surface point moves by dx, the
// reflected ray turns by dr.
void propagate(vec3 d, vec3 dd, vec3 de, float t, vec3 n, vec3 h, out vec3 dx, out vec3 dr)
{
    vec3 raw = de + t * dd;
    dx = raw - d * (dot(raw, n) / dot(d, n));
    vec3 dn = normal_change(dx, n, h);
    float size = length(d);
    vec3 v = d / size;
    vec3 dv = (dd - v * dot(v, dd)) / size;
    dr = dv - 2.0 * ((dot(dv, n) + dot(v, dn)) * n + dot(v, n) * dn);
}

// Step (6): where the ray x + s r meets the light's plane, and its change.
bool meet_light(vec3 x, vec3 r, vec3 dx[2], vec3 dr[2], out vec2 st, out mat2 jacobian)
{
    vec3 m = normal_uv.xyz;
    float approach = dot(m, r);
    float s = dot(m, centre.xyz - x) / approach;
    vec3 y = x + s * r - centre.xyz;
    st = 0.5 + vec2(dot(dual_u.xyz, y), dot(dual_v.xyz, y));
    for (int i = 0; i < 2; i++) {
        float ds = -dot(m, dx[i] + s * dr[i]) / approach;
        vec3 dy = dx[i] + s * dr[i] + r * ds;
        jacobian[i] = vec2(dot(dual_u.xyz, dy), dot(dual_v.xyz, dy));
    }
    return s > 0.0 && abs(approach) > 0.0;
}

float circles(vec2 st, mat2 jacobian)
{
    // Rings round the centre, `count` to the nearer edge of the light.
    vec2 q = (st - 0.5) * size.xy;
    float nearer = 0.5 * min(size.x, size.y), rho = length(q);
    vec2 radial = q / max(rho, 1e-20) * size.xy * (pattern.x / nearer);
    vec2 g = vec2(dot(radial, jacobian[0]), dot(radial, jacobian[1]));
    return stripe(rho * (pattern.x / nearer), g, pattern.y);
}

// The image over the pixel's parallelogram: samples along its longer side, each as wide as the
// shorter. Not textureGrad: software devices take one footprint for neighbouring pixels together.
vec4 image_colour(vec2 st, mat2 jacobian)
{
    const float most = 16.0;
    vec2 texels = vec2(textureSize(picture, 0));
    float a = length(jacobian[0] * texels), b = length(jacobian[1] * texels);
    vec2 along = a > b ? jacobian[0] : jacobian[1];
    float n = clamp(ceil(max(a, b) / max(min(a, b), 1.0)), 1.0, most);
    float lod = log2(max(max(a, b) / n, 1.0));
    vec4 sum = vec4(0.0);
    for (float i = 0.5; i < n; i += 1.0) {
        vec2 at = st + along * (i / n - 0.5);
        sum += textureLod(picture, vec2(at.x, 1.0 - at.y), lod);
    }
    return sum / n;
}

vec4 pattern_colour(vec2 st, mat2 jacobian)
{
#if PATTERN == IMAGE
    return image_colour(st, jacobian);
#else
    vec2 gs = vec2(jacobian[0].x, jacobian[1].x), gt = vec2(jacobian[0].y, jacobian[1].y);
#if PATTERN == CIRCLES
    float bright = circles(st, jacobian);
#else
    float bright = stripe(st.x * pattern.x, gs * pattern.x, pattern.y);
#endif
#if PATTERN == LATTICE
    // The same period in world units both ways.
    float rows = pattern.x * size.y / size.x;
    float along = stripe(st.y * rows, gt * rows, pattern.y);
    bright = 1.0 - (1.0 - bright) * (1.0 - along);
#endif
    return mix(background, foreground, bright);
#endif
}

// How much of the pixel falls on the light rectangle. Where the footprint spans all of the light it is
// no longer linear (the ray runs along the light's plane): the pixel's centre decides.
float on_light(vec2 st, mat2 jacobian)
{
    vec2 gs = vec2(jacobian[0].x, jacobian[1].x), gt = vec2(jacobian[0].y, jacobian[1].y);
    vec2 reach = vec2(abs(gs.x) + abs(gs.y), abs(gt.x) + abs(gt.y));
    vec2 outside = max(-st, st - 1.0);
    if (max(reach.x, reach.y) > 1.0)
        return max(outside.x, outside.y) <= 0.0 ? 1.0 : 0.0;
    return half_plane(st.x, gs) * half_plane(1.0 - st.x, gs) * half_plane(st.y, gt) *
           half_plane(1.0 - st.y, gt);
}

void store_miss(ivec2 p, vec4 rgba)
{
    const vec4 none = vec4(uintBitsToFloat(0x7fc00000u));
    imageStore(colour, p, rgba);
    if (want.x != 0)
        imageStore(light_st, p, none);
    if (want.y != 0)
        imageStore(curvature, p, none);
}

vec2 principal_curvatures(vec3 h)
{
    float mean = 0.5 * (h.x + h.z), radius = length(vec2(0.5 * (h.x - h.z), h.y));
    return vec2(mean - radius, mean + radius);
}

void main()
{
    if (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x >= n_blocks)
        return;
    ivec2 p = block_pixel(gl_WorkGroupID, gl_LocalInvocationID, gl_NumWorkGroups);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    vec4 place = imageLoad(position, p);
    if (place.w <= 0.0) {
        store_miss(p, empty);
        return;
    }
    vec4 facing = imageLoad(normal, p);
    vec3 n = facing.xyz;
    if (!(dot(n, n) > 0.5)) {  // a place without a normal mirrors nothing
        store_miss(p, miss);
        return;
    }
    vec3 h = vec3(imageLoad(shape, p).xy, facing.w);

    vec2 q = pixel_offset(p);
    vec3 d = to_world(vec3(q * ray.x, 1.0));
    vec3 dx[2], dr[2];
    for (int i = 0; i < 2; i++)
        propagate(d, axis[i].xyz * ray.x, axis[i].xyz * ray.y, place.w, n, h, dx[i], dr[i]);
    vec3 v = normalize(d);
    vec3 r = v - 2.0 * dot(v, n) * n;
    vec2 st;
    mat2 jacobian;
    bool met = meet_light(place.xyz, r, dx, dr, st, jacobian);
    bool inside = met && all(greaterThanEqual(st, vec2(0.0))) && all(lessThanEqual(st, vec2(1.0)));

    vec4 rgba = miss;
    if (met)
        rgba = mix(miss, pattern_colour(st, jacobian), on_light(st, jacobian));
    imageStore(colour, p, rgba);
    if (want.x != 0)
        imageStore(light_st, p, vec4(inside ? st : vec2(uintBitsToFloat(0x7fc00000u)), 0.0, 0.0));
    if (want.y != 0)
        imageStore(curvature, p, vec4(principal_curvatures(h), 0.0, 0.0));
}
