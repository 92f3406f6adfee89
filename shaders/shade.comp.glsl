// Stage 3, shade: what the light shows where the line family's ray meets it, averaged over the pixel.
// The formulas are in README.md; rays and lights in lines.glsl, patterns in patterns.glsl.
//
// Light, pattern and colours may change without stages 1 and 2. Several lights are several passes,
// the hindmost first; each blends over what is there.

layout(local_size_x = 64) in;

void main()
{
    ivec2 p = group_pixel(gl_WorkGroupID, gl_LocalInvocationIndex);
    if (any(greaterThanEqual(p, tile.zw)))
        return;
    Hit hit = hit_at(p);
    vec2 q = pixel_offset(p);
    Sample at = sample_at(q, 1.0, hit.depth, hit.n, hit.h, hit.n);
    Met met = meet(at);
    if (!IS_FILTERED) {  // one sample a pixel
        met.ds = met.dt = met.dtau = vec2(0.0);
        met.cover = float(met.inside);
    }
    Shown behind = shown_behind(p);
    bool is_hit = hit.depth > 0.0;
    Shown shown = mirrors(hit) ? lay_over(behind, at, met, q) : behind;
    put_shown(p, scaled(shown, float(is_hit)), float(!is_hit));
}
