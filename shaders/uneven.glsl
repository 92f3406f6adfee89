// Estimates how much a light's colour varies within a pixel, to list the pixels that their mean does not describe;
// those are shaded in parts.
//
// There are two causes. Where two lights lie over each other and both vary within the pixel, what shows through
// depends on which of their parts coincide. Where the surface or the light bends the pattern, its mean over a
// parallelogram is not exact.

// Standard deviations within the pixel.
struct Uneven {
    float light, alpha;  // of the colour; of the alpha, which hides what lies behind
};

// How far the pattern's phase extends over the pixel, in widths of the pattern's edges; a hard edge has no width.
float reach_in_edges(Met met)
{
    float reach = length(reach_of(met));
    if (PATTERN == RAINBOW)
        return reach * turn.z * 6.0;
    if (PATTERN == IMAGE)
        return length(reach_of(met) / size.xy * vec2(textureSize(picture, 0)));
    if (PATTERN == DISTANCE)
        reach = 0.5 * (abs(met.dtau.x) + abs(met.dtau.y));
    return reach / max(IS_SOFT ? PATTERN == LINES ? 2.0 * half_width * wave.w : wave.w / turn.z : 0.0, 1e-20);
}

// An upper bound. For a share it is the deviation of a pixel that shows only the two colours and nothing between
// them.
Uneven unevenness(Met met, vec4 mean, vec4 own)
{
    float most = min(0.5, reach_in_edges(met));
    Uneven pattern = Uneven(most, 0.0);
    if (PATTERN == IMAGE)
        pattern.alpha = min(most, sqrt(max(mean.a - mean.a * mean.a, 0.0)));
    else if (PATTERN != RAINBOW) {
        vec4 apart = foreground - background;
        float bright = clamp(dot(mean - background, apart) / max(dot(apart, apart), 1e-20), 0.0, 1.0);
        most = min(most, sqrt(bright - bright * bright));
        vec3 colour = abs(apart.rgb);
        pattern = Uneven(most * max(max(colour.r, colour.g), colour.b), most * abs(apart.a));
    }
    float border = sqrt(max(met.cover - met.cover * met.cover, 0.0)), share = met.cover * opacity;
    return Uneven(share * pattern.light + border, share * pattern.alpha + border * own.a);
}

// A smaller deviation from the mean counts as even; in light.
const float LEAST_UNEVEN = 0.01;
// A pattern farther off its parallelogram than this counts as bent, px.
const float LEAST_BEND = 0.04;
// Where the normal turns by more than this, rad, a pixel may be uneven although its parallelogram is not. With a
// light that has a border, MOST_TURN is enough, since the parallelogram may not reach the border.
const float LARGE_TURN = 0.1;

// Distance of the pattern from its parallelogram at the pixel's sides, px. There are two causes: the turning of the
// normal changes from pixel to pixel, and the light's coordinates bend as the ray turns.
float bend_of(Sample at, Met met, ivec2 p)
{
    vec3 r, dr[2];
    float change = 0.0, turn = 1e-6, bend = 0.0;
    ray_from(at, r, dr);
    for (int i = 0; i < 2; i++) {
        ivec2 step = ivec2(1 - i, i);
        vec3 before = imageLoad(normal, max(p - step, ivec2(0))).xyz;
        vec3 after = imageLoad(normal, min(p + step, tile.zw - 1)).xyz;
        change = max(change, length(0.5 * (before + after) - at.n));
        turn = max(turn, length(dr[i]));
        bend = max(bend, abs(met.dtau[i]) / max(met.tau, 1e-20));
    }
    if (FAMILY == ZEBRA || FAMILY == ENVIRONMENT || LIGHT == SPHERE)  // azimuths turn faster towards the axis
        bend = turn / max(length(cross(r, axis_n.xyz)), 1e-3);
    return 0.5 * change / turn + 0.25 * bend;
}

// Whether the light may end within so many reaches of the parallelogram: the surface bends less than that.
const float END_REACHES = 3.0;

bool may_end(Met met)
{
    if (FAMILY != REFLECTION && FAMILY != HIGHLIGHT)
        return false;
    if (LIGHT == PLANE)  // at its horizon
        return END_REACHES * 0.5 * (abs(met.dtau.x) + abs(met.dtau.y)) > met.tau;
    if (LIGHT != RECTANGLE)
        return false;
    vec2 place = abs(met.q / size.xy), reach = END_REACHES * reach_of(met) / size.xy;
    return all(lessThan(place, 0.5 + reach)) && any(greaterThan(place, 0.5 - reach));
}

bool is_bent(Sample at, Met met, ivec2 p, Hit hit, Uneven uneven)
{
    float turn = turn_over_pixel(p, hit);
    if (turn > MOST_TURN)
        return uneven.light > LEAST_UNEVEN || turn > LARGE_TURN || may_end(met);
    return uneven.light > LEAST_UNEVEN && bend_of(at, met, p) > LEAST_BEND;
}
