// Stage 3, shade: what the light shows where the line family's ray meets it, averaged over the pixel. README.md has
// the formulas, lines.glsl the rays and lights, patterns.glsl the patterns.
//
// Light, pattern and colours may change without a new stage 1 or 2. Several lights take several passes, the hindmost
// first; each blends over the result of the pass before. The pass of the foremost light lists the pixels that are
// shaded in parts (uneven.glsl).

layout(local_size_x = 64) in;

LIST(2, Parts, parts);

layout(binding = 5, r16f) writeonly uniform image2D next_uneven;
layout(binding = 4) uniform sampler2D behind_uneven;

// In the plane of deviations, this value marks a pixel as one to list.
const float IN_PARTS = 2.0;

float uneven_behind(ivec2 p)
{
    if (is_hindmost)
        return 0.0;
    return texelFetch(behind_uneven, p, 0).x;
}

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    Hit hit = hit_at(p);
    vec2 q = pixel_offset(p);
    Sample at = sample_at(q, 1.0, hit.depth, hit.n, hit.h, hit.n);
    Met met = meet(at);
    if (!IS_FILTERED) {  // one sample per pixel
        met.ds = met.dt = met.dtau = vec2(0.0);
        met.cover = float(met.inside);
    }
    Shown behind = shown_behind(p);
    bool is_hit = hit.depth > 0.0;
    vec4 mean = mean_colour(met), own = own_light(at, mean, q);
    Shown shown = mirrors(hit) ? laid_over(behind, own, met.cover) : behind;
    put_shown(p, scaled(shown, float(is_hit)), float(!is_hit));
    if (want.w == 0)
        return;
    Uneven uneven = unevenness(met, mean, own);
    float before = uneven_behind(p);
    bool in_parts = is_bent(at, met, p, hit, uneven) || before >= IN_PARTS || before * uneven.alpha > LEAST_UNEVEN;
    if (!is_foremost)
        imageStore(next_uneven, p, vec4(in_parts ? IN_PARTS : uneven.light + (1.0 - met.cover * own.a) * before));
    else if (in_parts && mirrors(hit) && imageLoad(border, p).x != ROUNDED && !is_at_edge(p, hit))
        LIST_ADD(parts, p, 64u)
}
