// Box-filtered coverage of a pixel, exact for a phase that is linear over the pixel (server/surface/README.md 7.3).
// The gradient g of a phase is its change per pixel in x and in y. Projected along the phase, the unit pixel square
// becomes a trapezoid; the functions here integrate over it.

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

// Mean over the pixel of max(f, 0), where f is linear with value z at the centre and gradient g.
float ramp(float z, vec2 g)
{
    g = abs(g);
    float a = max(max(g.x, g.y), 1e-20), b = min(g.x, g.y);
    float reach = 0.5 * (a + b), t = -abs(z), in_reach = max(t + reach, 0.0), over = t + 0.5 * a;
    float below = t < 0.5 * (b - a) ? in_reach * in_reach * in_reach / (6.0 * a * b)
                                    : (over * over + b * b / 12.0) / (2.0 * a);
    return max(z, 0.0) + (t > -reach ? below : 0.0);
}

// The square wave of period 1 and duty d less its mean, integrated twice.
float twice_integrated(float phase, float d)
{
    float r = fract(phase);
    float s = r < d ? 0.5 * r * r : 0.5 * d * d + d * (r - d);
    return s - 0.5 * d * r * r - 0.5 * d * (1.0 - d) * r;
}

// The square wave that is 1 where fract(phase) < d, averaged over the pixel. As the pattern becomes finer than the
// pixel the result approaches its mean d.
float stripe(float phase, vec2 g, float d)
{
    if (d >= 1.0)  // rising and falling edges coincide
        return 1.0;
    g = abs(g);
    float reach = 0.5 * (g.x + g.y), thin = min(g.x, g.y);
    if (reach < 0.25) {
        // At most the nearest rising and falling edges lie inside, so nothing cancels.
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

// Share of the pixel where two linear functions p and q, both 0 at its centre, lie between low and high: the area of
// a parallelogram within a box. By Green's theorem it is the sum, over the parallelogram's edges, of the integral of
// clamp(p) dq between the bounds of q. Neither gradient may be 0.
float box_share(vec2 low, vec2 high, vec2 gp, vec2 gq)
{
    // A parallelogram that is nearly a line is widened to a thousandth of its sides.
    float area = gp.x * gq.y - gp.y * gq.x, qq = dot(gq, gq);
    float lacking = max(1e-3 * sqrt(dot(gp, gp) * qq) - abs(area), 0.0);
    gp += (area < 0.0 ? -lacking : lacking) / qq * vec2(gq.y, -gq.x);
    float reach = 0.5 * (abs(gp.x) + abs(gp.y)), sum = 0.0;
    // The bounds of p are limited to what the pixel reaches, so that no large numbers cancel.
    float p0 = clamp(low.x, -reach, reach), p1 = clamp(high.x, -reach, reach);
    for (int i = 0; i < 2; i++) {  // the edges along x, the edges along y
        float dp = gp[i], dq = gq[i];
        bool is_flat = abs(dp) < 1e-3 * reach;
        float slope = dq / (is_flat ? 1.0 : dp), per_q = 1.0 / (abs(dq) < 1e-20 ? 1e-20 : dq);
        for (float side = -1.0; side < 2.0; side += 2.0) {
            float p = 0.5 * (side * gp[1 - i] - dp), q = 0.5 * (side * gq[1 - i] - dq);
            vec2 within = clamp(vec2(q, q + dq), low.y, high.y);
            vec2 ends = p + clamp((within - q) * per_q, 0.0, 1.0) * dp;
            vec2 inside = clamp(ends, p0, p1), below = min(ends, p0), above = max(ends, p1);
            float mean = 0.5 * (inside.x + inside.y);
            float whole = mean * (inside.y - inside.x) + p0 * (below.y - below.x) +
                          p1 * (above.y - above.x);
            float part = is_flat ? mean * (within.y - within.x) : whole * slope;
            sum += i == 0 ? -side * part : side * part;
        }
    }
    return clamp(sum / (gp.x * gq.y - gp.y * gq.x), 0.0, 1.0);
}

// A linear function over the pixel: its value at the centre and its gradient.
struct Border {
    float at_centre;
    vec2 change;
};

// Share of the pixel where four linear functions are positive: the pixel's square, cut by each line in turn.
float share_within(Border border[4])
{
    bool is_outside = false, is_crossed = false;
    for (int k = 0; k < 4; k++) {
        float reach = 0.5 * (abs(border[k].change.x) + abs(border[k].change.y));
        is_outside = is_outside || border[k].at_centre <= -reach;
        is_crossed = is_crossed || abs(border[k].at_centre) < reach;
    }
    vec2 polygon[8];
    polygon[0] = vec2(-0.5);
    polygon[1] = vec2(0.5, -0.5);
    polygon[2] = vec2(0.5);
    polygon[3] = vec2(-0.5, 0.5);
    int n = 4;
    // Few pixels have work here. Some devices execute every branch, but not a loop whose end is already reached.
    for (int k = is_crossed && !is_outside ? 0 : 4; k < 4; k++) {
        vec2 cut[8], last = polygon[max(n - 1, 0)];
        float last_at = border[k].at_centre + dot(border[k].change, last);
        int left = 0;
        for (int i = 0; i < n; i++) {
            vec2 next = polygon[i];
            float next_at = border[k].at_centre + dot(border[k].change, next);
            if ((last_at > 0.0) != (next_at > 0.0))
                cut[left++] = mix(last, next, last_at / (last_at - next_at));
            if (next_at > 0.0)
                cut[left++] = next;
            last = next;
            last_at = next_at;
        }
        polygon = cut;
        n = left;
    }
    float twice = 0.0;
    for (int i = 1; i < n - 1; i++) {
        vec2 a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
        twice += a.x * b.y - a.y * b.x;
    }
    return is_outside || n < 3 ? 0.0 : clamp(0.5 * twice, 0.0, 1.0);
}
