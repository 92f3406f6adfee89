// What the light shows at a place, averaged over the pixel's footprint there. Colours here are linear
// light, premultiplied by their alpha, so that their mean over a pixel is what the pixel shows.
//
// Defined before this file: PATTERN, and SOFT for soft edges: a program for each kind, since some
// devices walk through every branch.

#define STRIPES 0
#define LATTICE 1
#define CIRCLES 2
#define IMAGE 3
#define LINES 4
#define RAINBOW 5
#define DISTANCE 6

layout(binding = 0) uniform sampler2D picture;

// Soft edges are one more box that the pattern is convolved with. The two widest boxes are integrated
// in closed form, the narrowest by Gauss's rule of three points, under which the result is a
// piecewise quadratic function: points and weights.
const vec3 GAUSS = vec3(-0.387298335, 0.0, 0.387298335), WEIGHT = vec3(5.0, 8.0, 5.0) / 18.0;

void sort_boxes(vec2 g, float soft, out vec2 wide, out float narrow)
{
    g = abs(g);
    narrow = min(min(g.x, g.y), soft);
    wide.x = max(max(g.x, g.y), soft);
    wide.y = g.x + g.y + soft - narrow - wide.x;
}

// The wave of duty d, its edges as wide as `soft`.
float soft_stripe(float phase, vec2 g, float d, float soft)
{
    vec2 wide;
    float narrow;
    sort_boxes(g, soft, wide, narrow);
    vec3 at = phase + narrow * GAUSS;
    return dot(WEIGHT, vec3(stripe(at.x, wide, d), stripe(at.y, wide, d), stripe(at.z, wide, d)));
}

// half_plane with an edge as wide as `soft`, in units of z.
float soft_half_plane(float z, vec2 g, float soft)
{
    vec2 wide;
    float narrow;
    sort_boxes(g, soft, wide, narrow);
    vec3 at = z + narrow * GAUSS;
    return dot(WEIGHT, vec3(half_plane(at.x, wide), half_plane(at.y, wide), half_plane(at.z, wide)));
}

float wave_at(float phase, vec2 g)
{
#ifdef SOFT
    return soft_stripe(phase, g, wave.z, wave.w);
#else
    return stripe(phase, g, wave.z);
#endif
}

#if PATTERN == LATTICE
// Where neither wave has a bright part: the pixel's share of it. The product of both is exact where
// one wave is constant over the pixel, or neither changes along what the other changes along.
float lattice_dark(vec2 phase, vec2 da, vec2 db)
{
    vec2 dark = 1.0 - vec2(wave_at(phase.x, da), wave_at(phase.y, db));
    vec2 least = min(abs(da), abs(db)), most = max(abs(da), abs(db));
    bool is_turned = any(greaterThan(least, 1e-3 * most)) && min(dark.x, dark.y) > 0.0 &&
                     max(dark.x, dark.y) < 1.0;
    vec2 reach = 0.5 * (abs(vec2(da.x, db.x)) + abs(vec2(da.y, db.y)));
    float sum = 0.0;
#ifdef SOFT
    // Over parts of the pixel the product is good enough.
    int side = max(reach.x, reach.y) > 0.75 ? 8 : 4, n = is_turned ? side * side : 0;
    for (int i = 0; i < n; i++) {
        vec2 at = (vec2(i % side, i / side) + 0.5) / float(side) - 0.5;
        sum += (1.0 - wave_at(phase.x + dot(da, at), da / float(side))) *
               (1.0 - wave_at(phase.y + dot(db, at), db / float(side)));
    }
    sum /= float(side * side);
#else
    // The dark cells that the pixel may touch. Past so many of them the product is good enough.
    const float most_cells = 64.0;
    vec2 first = floor(phase - reach), cells = ceil(phase + reach - wave.z) - first;
    int n = is_turned && cells.x * cells.y <= most_cells ? int(cells.x * cells.y) : 0;
    for (int i = 0; i < n; i++) {
        vec2 cell = first + vec2(i % int(cells.x), i / int(cells.x)) - phase;
        sum += box_share(cell + wave.z, cell + 1.0, da, db);
    }
#endif
    return n > 0 ? sum : dark.x * dark.y;
}
#endif

// The image over the pixel's parallelogram: samples along its longer side, each as wide as the
// shorter. Not textureGrad: software devices take one footprint for neighbouring pixels together.
vec4 image_colour(vec2 st, vec2 right, vec2 down)
{
    const float most = 16.0;
    vec2 texels = vec2(textureSize(picture, 0));
    float a = length(right * texels), b = length(down * texels);
    vec2 along = a > b ? right : down;
    float n = clamp(ceil(max(a, b) / max(min(a, b), 1.0)), 1.0, most);
    float lod = log2(max(max(a, b) / n, 1.0));
    vec4 sum = vec4(0.0);
    for (float i = 0.5; i < n; i += 1.0) {
        vec2 at = st + along * (i / n - 0.5);
        sum += textureLod(picture, vec2(at.x, 1.0 - at.y), lod);
    }
    return clamp(sum / n, 0.0, 1.0);
}

// A coordinate turned on the light, and its change over the pixel.
void turned(Met met, vec2 along, out float a, out vec2 da)
{
    a = dot(along, met.q);
    da = along.x * met.ds + along.y * met.dt;
}

float line_edge(float z, vec2 g)
{
#ifdef SOFT
    return soft_half_plane(z, g, wave.w * 2.0 * half_width);
#else
    return half_plane(z, g);
#endif
}

// Single lines: how much of the pixel they cover.
float lines_at(float a, vec2 da)
{
    float bright = 0.0;
    for (int i = 0; i < n_single; i++) {
        float z = a - single[i >> 2][i & 3];
        bright += line_edge(z + half_width, da) - line_edge(z - half_width, da);
    }
    return min(bright, 1.0);
}

vec4 pattern_colour(Met met)
{
    vec2 da, db;
    float a, b;
    turned(met, turn.xy, a, da);
    turned(met, vec2(-turn.y, turn.x), b, db);
#if PATTERN == IMAGE
    vec2 right = vec2(da.x, db.x) / size.xy, down = vec2(da.y, db.y) / size.xy;
    return image_colour(vec2(a, b) / size.xy + 0.5, right, down);
#elif PATTERN == RAINBOW
    // Each channel of a turn of hue is a wave whose edges take a sixth.
    vec3 rgb;
    for (int i = 0; i < 3; i++)
        rgb[i] = soft_stripe(a * turn.z + wave.x + 0.25 - float(i) / 3.0, da * turn.z, 0.5, 1.0 / 6.0);
    return vec4(rgb, 1.0);
#else
#if PATTERN == CIRCLES
    float rho = length(met.q);
    vec2 radial = met.q / max(rho, 1e-20) * turn.z;
    float bright = wave_at(rho * turn.z + turn.w, radial.x * met.ds + radial.y * met.dt);
#elif PATTERN == LINES
    float bright = lines_at(a, da);
#elif PATTERN == LATTICE
    float bright =
        1.0 - lattice_dark(vec2(a, b) * turn.z + wave.xy, da * turn.z, db * turn.z);
#elif PATTERN == DISTANCE
    float bright = wave_at(met.tau * turn.z + turn.w, met.dtau * turn.z);
#else
    float bright = wave_at(a * turn.z + wave.x, da * turn.z);
#endif
    return mix(background, foreground, bright);
#endif
}

// The pattern over the shaded base, over the lights behind; q as for sample_at.
Shown lay_over(Shown behind, Sample at, Met met, vec2 q)
{
    float lit = 0.3 + 0.7 * abs(dot(at.n, normalize(to_world(vec3(q * ray.x, 1.0)))));
    vec4 own = met.cover * mix(vec4(base.rgb * lit, base.a), pattern_colour(met), opacity);
    return Shown(own + (1.0 - own.a) * behind.light, (1.0 - met.cover) * behind.missed);
}
