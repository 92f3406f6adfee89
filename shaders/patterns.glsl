// What the light shows at a place, averaged over the pixel's footprint there. Colours here are linear light,
// premultiplied by their alpha, so that their mean over a pixel is what the pixel shows.
//
// The including program defines PATTERN; IS_SOFT, whether edges are soft; IS_FILTERED, whether a pixel shows a mean
// or what its centre meets. For devices that execute every branch these are constants, in one program for each kind.

#define STRIPES 0
#define LATTICE 1
#define CIRCLES 2
#define IMAGE 3
#define LINES 4
#define RAINBOW 5
#define DISTANCE 6

layout(binding = 0) uniform sampler2D picture;

// A soft edge is one more box that the pattern is convolved with. The two widest boxes are integrated in closed form,
// the narrowest by Gauss's rule of three points; with it the result is a piecewise quadratic function. Points and
// weights of the rule:
const vec3 GAUSS = vec3(-0.387298335, 0.0, 0.387298335), WEIGHT = vec3(5.0, 8.0, 5.0) / 18.0;

void sort_boxes(vec2 g, float soft, out vec2 wide, out float narrow)
{
    g = abs(g);
    narrow = min(min(g.x, g.y), soft);
    wide.x = max(max(g.x, g.y), soft);
    wide.y = g.x + g.y + soft - narrow - wide.x;
}

// Edges whose softness is less than this share of the distance over which they are integrated count as hard: single
// precision has no digits left for them.
const float LEAST_SOFT = 1e-3;

// The wave of duty d with edges as wide as `soft`. Where the pixel takes less than a period, the result is the sum of
// the waves in reach. Each lies between four ramps, taken on the side where they vanish, so that dark values keep all
// their digits, as the sRGB curve needs.
float soft_stripe(float phase, vec2 g, float d, float soft)
{
    float reach = 0.5 * (abs(g.x) + abs(g.y)), sum = 0.0;
    if (reach < 0.5) {
        soft = max(soft, LEAST_SOFT * max(reach, 0.1));
        float x = phase - 0.5 * d, outer = 0.5 * (d + soft), inner = 0.5 * (d - soft);
        // Counted from the first, at most five: beyond 2^24 a number and its successor are the same.
        float first = ceil(x - outer - reach), n = min(floor(x + outer + reach) - first, 4.0);
        for (float i = 0.0; i <= n; i += 1.0) {
            float y = -abs(x - (first + i));
            sum += ramp(y + outer, g) - ramp(y + inner, g) - ramp(y - inner, g) + ramp(y - outer, g);
        }
        return sum / soft;
    }
    vec2 wide;
    float narrow;
    sort_boxes(g, soft, wide, narrow);
    for (int i = 0; i < 3; i++)
        sum += WEIGHT[i] * stripe(phase + narrow * GAUSS[i], wide, d);
    return sum;
}

// half_plane() with an edge as wide as `soft`, in units of z.
float soft_half_plane(float z, vec2 g, float soft)
{
    float reach = 0.5 * (abs(g.x) + abs(g.y));
    soft = max(soft, LEAST_SOFT * reach);
    z = clamp(z, -reach - soft, reach + soft);
    return (ramp(z + 0.5 * soft, g) - ramp(z - 0.5 * soft, g)) / soft;
}

float wave_at(float phase, vec2 g)
{
    if (IS_SOFT)
        return soft_stripe(phase, g, wave.z, wave.w);
    return stripe(phase, g, wave.z);
}

// Share of the pixel in which neither wave is bright. The product of the two dark shares is exact where one wave is
// constant over the pixel, or where only one wave changes along each axis of the pixel.
float lattice_dark(vec2 phase, vec2 da, vec2 db)
{
    vec2 dark = 1.0 - vec2(wave_at(phase.x, da), wave_at(phase.y, db));
    vec2 least = min(abs(da), abs(db)), most = max(abs(da), abs(db));
    bool is_turned = any(greaterThan(least, 1e-3 * most)) && min(dark.x, dark.y) > 0.0 &&
                     max(dark.x, dark.y) < 1.0;
    vec2 reach = 0.5 * (abs(vec2(da.x, db.x)) + abs(vec2(da.y, db.y)));
    float sum = 0.0;
    if (IS_SOFT) {
        // The product is exact enough over parts of the pixel.
        int side = max(reach.x, reach.y) > 0.75 ? 8 : 4, n = is_turned ? side * side : 0;
        for (int i = 0; i < n; i++) {
            vec2 at = (vec2(i % side, i / side) + 0.5) / float(side) - 0.5;
            sum += (1.0 - wave_at(phase.x + dot(da, at), da / float(side))) *
                   (1.0 - wave_at(phase.y + dot(db, at), db / float(side)));
        }
        return n > 0 ? sum / float(side * side) : dark.x * dark.y;
    }
    // The dark cells that the pixel may touch. Beyond this number of cells the product is exact enough.
    const float most_cells = 64.0;
    vec2 first = floor(phase - reach), cells = ceil(phase + reach - wave.z) - first;
    int n = is_turned && cells.x * cells.y <= most_cells ? int(cells.x * cells.y) : 0;
    for (int i = 0; i < n; i++) {
        vec2 cell = first + vec2(i % int(cells.x), i / int(cells.x)) - phase;
        sum += box_share(cell + wave.z, cell + 1.0, da, db);
    }
    return n > 0 ? sum : dark.x * dark.y;
}

// The mean of the image over the pixel's parallelogram, from samples on a grid along its two sides. The samples are
// one texel of the chosen level apart, so that every texel counts alike. The level is the finest for which about the
// allowed number of samples is enough; what one of its texels blurs beyond the footprint is small compared with the
// shorter side. (textureGrad() is not used: software devices use one footprint for neighbouring pixels together.)
vec4 image_colour(vec2 st, vec2 right, vec2 down)
{
    const float few = 5.0, many = 40.0, most = 64.0;
    vec2 texels = vec2(textureSize(picture, 0));
    vec2 a = right * texels, b = down * texels;
    bool swap = dot(a, a) < dot(b, b);
    vec2 along = swap ? down : right, across = swap ? right : down;
    vec2 u = along * texels, v = across * texels;
    float length_u = max(length(u), 1e-6), height = abs(u.x * v.y - u.y * v.x) / length_u;
    float step = max(height / few, sqrt(length_u * max(height, length_u / many) / many));
    float lod = max(round(log2(max(step, 1.0))), 0.0), texel = exp2(lod);
    // Rows that are shifted against each other add to the samples along them.
    float shift = abs(dot(u, v)) / (length_u * length_u);
    vec2 n = clamp(ceil(vec2(length_u / texel, max(height / texel, few * shift)) + 1.0), 2.0, most);
    vec4 sum = vec4(0.0);
    for (float j = 0.5; j < n.y; j += 1.0)
        for (float i = 0.5; i < n.x; i += 1.0) {
            vec2 at = st + along * (i / n.x - 0.5) + across * (j / n.y - 0.5);
            sum += textureLod(picture, vec2(at.x, 1.0 - at.y), lod);
        }
    return clamp(sum / (n.x * n.y), 0.0, 1.0);
}

// A coordinate on the light after the pattern's rotation, and its change over the pixel.
void turned(Met met, vec2 along, out float a, out vec2 da)
{
    a = dot(along, met.q);
    da = along.x * met.ds + along.y * met.dt;
}

float line_edge(float z, vec2 g)
{
    return IS_SOFT ? soft_half_plane(z, g, wave.w * 2.0 * half_width) : half_plane(z, g);
}

// Pattern `lines`: share of the pixel that they cover.
float lines_at(float a, vec2 da)
{
    float bright = 0.0;
    for (int i = 0; i < n_single; i++) {
        float z = a - single[i >> 2][i & 3];
        bright += line_edge(z + half_width, da) - line_edge(z - half_width, da);
    }
    return min(bright, 1.0);
}

// Over a turn of hue each channel is a wave whose edges take a sixth of the turn.
vec4 rainbow(float a, vec2 da)
{
    vec3 rgb;
    for (int i = 0; i < 3; i++)
        rgb[i] = soft_stripe(a * turn.z + wave.x + 0.25 - float(i) / 3.0, da * turn.z, 0.5, 1.0 / 6.0);
    return vec4(rgb, 1.0);
}

float circles_at(Met met)
{
    float rho = length(met.q);
    vec2 radial = met.q / max(rho, 1e-20) * turn.z, g = radial.x * met.ds + radial.y * met.dt;
    g *= min(1.0, rho * turn.z / max(0.5 * (abs(g.x) + abs(g.y)), 1e-20));  // there is no ring beyond the centre
    return wave_at(rho * turn.z + turn.w, g);
}

vec4 pattern_colour(Met met)
{
    vec2 da, db;
    float a, b, bright;
    turned(met, turn.xy, a, da);
    turned(met, vec2(-turn.y, turn.x), b, db);
    if (PATTERN == IMAGE) {
        vec2 right = vec2(da.x, db.x) / size.xy, down = vec2(da.y, db.y) / size.xy;
        return image_colour(vec2(a, b) / size.xy + 0.5, right, down);
    }
    if (PATTERN == RAINBOW)
        return rainbow(a, da);
    if (PATTERN == CIRCLES)
        bright = circles_at(met);
    else if (PATTERN == LINES)
        bright = lines_at(a, da);
    else if (PATTERN == LATTICE)
        bright = 1.0 - lattice_dark(vec2(a, b) * turn.z + wave.xy, da * turn.z, db * turn.z);
    else if (PATTERN == DISTANCE)
        bright = wave_at(met.tau * turn.z + turn.w, met.dtau * turn.z);
    else
        bright = wave_at(a * turn.z + wave.x, da * turn.z);
    return mix(background, foreground, bright);
}

// A footprint that cannot be averaged as a whole is cut into parts: at the border of a light, at the seam of a light
// that closes on itself, where a pattern whose periods do not close meets itself, and where rings bend. A part's
// weight is the share that border and seam leave of it.

// Whether the light closes on itself, and along which coordinate.
bool has_seam()
{
    return FAMILY == ZEBRA || FAMILY == ENVIRONMENT || (FAMILY != ISOPHOTE && (LIGHT == TUNNEL || LIGHT == SPHERE));
}

int around()
{
    return FAMILY == ZEBRA ? 1 : 0;
}

bool has_border()
{
    return LIGHT == RECTANGLE && (FAMILY == REFLECTION || FAMILY == HIGHLIGHT);
}

// How far the footprint extends to the sides, in q.
vec2 reach_of(Met met)
{
    return 0.5 * vec2(abs(met.ds.x) + abs(met.ds.y), abs(met.dt.x) + abs(met.dt.y));
}

bool is_at_seam(Met met)
{
    return has_seam() && abs(met.q[around()]) + reach_of(met)[around()] > 0.5 * size[around()];
}

// Into how many parts the footprint is cut in each direction.
float parts_across(Met met, bool at_seam)
{
    bool at_border = has_border() && abs(met.cover - 0.5) < 0.499;
    float n = at_border || at_seam ? 4.0 : 1.0;
    if (PATTERN != CIRCLES)
        return n;
    // How far a ring bends away from a straight line over half of the footprint, in periods. Where so many rings lie
    // in the footprint that only the mean is left, only the rings at its middle show more.
    const float straight = 0.01, most = 8.0, many = 12.0;
    vec2 right = 0.5 * vec2(met.ds.x, met.dt.x), down = 0.5 * vec2(met.ds.y, met.dt.y);
    float reach = max(length(right + down), length(right - down));
    float rho = length(met.q), bend = 0.5 * reach * reach * turn.z / max(rho, 1e-3 * reach);
    if (bend > straight && (2.0 * reach * turn.z < many || rho < 2.0 * reach))
        n = max(n, min(ceil(sqrt(bend / straight)), most));
    return n;
}

// Approximate share of a part that lies on the light; more than 0, so that some part counts.
float part_share(Met part)
{
    vec2 inside = (0.5 * size.xy - abs(part.q)) / max(2.0 * reach_of(part), 1e-20);
    vec2 share = clamp(inside + 0.5, 1e-3, 1.0);
    return has_border() ? share.x * share.y : has_seam() ? share[around()] : 1.0;
}

// The pattern's mean over the part of the footprint that lies on the light.
vec4 mean_colour(Met met)
{
    if (!IS_FILTERED || !(has_border() || has_seam() || PATTERN == CIRCLES))
        return pattern_colour(met);
    bool at_seam = is_at_seam(met);
    float step = 1.0 / parts_across(met, at_seam), weight = 0.0;
    Met part = met;
    part.ds *= step;
    part.dt *= step;
    part.dtau *= step;
    vec2 q = met.q, first = vec2(0.5 * (step - 1.0)), at = first;
    vec4 sum = vec4(0.0);
    // At a seam a second time, from the other end of the light.
    for (int ends = at_seam ? 2 : 1; ends > 0;) {
        part.q = q + at.x * vec2(met.ds.x, met.dt.x) + at.y * vec2(met.ds.y, met.dt.y);
        part.tau = met.tau + dot(met.dtau, at);
        float share = part_share(part);
        sum += share * pattern_colour(part);
        weight += share;
        at.x += step;
        at = at.x < 0.5 ? at : vec2(first.x, at.y + step);
        if (at.y >= 0.5) {
            at = first;
            ends--;
            q[around()] -= q[around()] < 0.0 ? -size[around()] : size[around()];
        }
    }
    return sum / weight;
}

// The pattern's mean laid over the shaded base; q as in sample_at().
vec4 own_light(Sample at, vec4 mean, vec2 q)
{
    float lit = 0.3 + 0.7 * abs(dot(at.n, normalize(to_world(vec3(q * ray.x, 1.0)))));
    return mix(vec4(base.rgb * lit, base.a), mean, opacity);
}

// Lays a light that is met by the share `cover` of an area over the lights behind it.
Shown laid_over(Shown behind, vec4 own, float cover)
{
    own *= cover;
    return Shown(own + (1.0 - own.a) * behind.light, (1.0 - cover) * behind.missed);
}

Shown lay_over(Shown behind, Sample at, Met met, vec2 q)
{
    return laid_over(behind, own_light(at, mean_colour(met), q), met.cover);
}
