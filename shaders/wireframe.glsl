// The edges of polygons (--surface wireframe:LEVEL): lines WIDTH px wide, half of it on either side, from the
// distance in the picture to the nearest edge. The grid's coordinates are linear over a triangle, so the diagonal of
// a quad is no edge.
//
// Where lines come close they become thinner, so that those of one direction take at most MOST of the surface. Where
// the pixels cannot resolve them they fade to that mean: a fine mesh becomes a grey, not noise.

const float WIDTH = 1.0, MOST = 0.2;
const vec3 LINE = vec3(0.010), FILL = vec3(0.71);  // linear light

// Share of the pixel under the lines of one of the grid's directions. `change` is the change of `at` by a pixel to
// the right and by a pixel down.
float line(float at, vec2 change, bool is_fan)
{
    float nearest = round(at);
    float per_px = max(length(change), 1e-20);
    float width = min(WIDTH, MOST / per_px);
    float px = abs(at - nearest) / per_px;
    float sharp = clamp(0.5 + 0.5 * width - px, 0.0, min(width, 1.0));
    float mean = width * per_px;
    // In a triangle of a fan only the edges at the n-gon's corner are edges.
    return is_fan && nearest > 0.0 ? 0.0 : mix(sharp, mean, smoothstep(0.4, 0.8, per_px));
}

// The colour of a pixel, sRGB-encoded.
vec4 wireframe_colour(vec2 grid, vec2 change_x, vec2 change_y, bool is_fan)
{
    float ink = 1.0 - (1.0 - line(grid.x, vec2(change_x.x, change_y.x), is_fan)) *
                          (1.0 - line(grid.y, vec2(change_x.y, change_y.y), is_fan));
    return vec4(srgb_encoded(mix(FILL, LINE, ink)), 1.0);
}
