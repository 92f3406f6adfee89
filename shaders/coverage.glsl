// Box-filtered coverage of a pixel, exact for a phase that is linear over the pixel
// (limit-surface 5.2). A phase's gradient g is its change per pixel in x and in y; the unit pixel
// square projects to a trapezoid along the phase, whose ramps these functions integrate.

// Share of the pixel where a linear function with value z at its centre and gradient g is positive.
float half_plane(float z, vec2 g)
{
    g = abs(g);
    float a = max(max(g.x, g.y), 1e-20), b = min(g.x, g.y);
    float reach = 0.5 * (a + b), t = abs(z);
    float inside = t < 0.5 * (a - b) ? 0.5 - t / a : (reach - t) * (reach - t) / (2.0 * a * b);
    inside = t >= reach ? 0.0 : inside;
    return z > 0.0 ? 1.0 - inside : inside;
}

// Twice integrated square wave of period 1 and duty d, its mean removed.
float twice_integrated(float phase, float d)
{
    float r = fract(phase);
    float s = r < d ? 0.5 * r * r : 0.5 * d * d + d * (r - d);
    return s - 0.5 * d * r * r - 0.5 * d * (1.0 - d) * r;
}

// Filtered square wave: 1 where fract(phase) < d. As the pattern becomes finer than the pixel it
// goes to its mean d.
float stripe(float phase, vec2 g, float d)
{
    if (d >= 1.0)  // its edges meet and cancel
        return 1.0;
    g = abs(g);
    float reach = 0.5 * (g.x + g.y), thin = min(g.x, g.y);
    if (reach < 0.25) {
        // At most the nearest rising and falling edges are inside: no cancellation.
        float rise = round(phase), fall = round(phase - d) + d;
        float wave = half_plane(phase - rise, g) - half_plane(phase - fall, g);
        return fall < rise ? wave + 1.0 : wave;
    }
    if (thin < 1e-2) {  // the pixel is a segment: one integral
        float w = max(g.x, g.y), a = fract(phase - 0.5 * w), b = fract(phase + 0.5 * w);
        return clamp(d + (min(b, d) - d * b - min(a, d) + d * a) / w, 0.0, 1.0);
    }
    float diff = 0.5 * (g.x - g.y);
    float sum = twice_integrated(phase + reach, d) - twice_integrated(phase + diff, d) -
                twice_integrated(phase - diff, d) + twice_integrated(phase - reach, d);
    return clamp(d + sum / (g.x * g.y), 0.0, 1.0);
}
