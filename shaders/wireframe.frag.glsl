// The edges of the polygons (--surface wireframe:LEVEL) over the picture that was shaded: lines of
// WIDTH px in all, half of it on either side, by the distance in the picture to the nearest edge.
// The grid's coordinates are linear over a triangle, so the diagonal of a quad is no edge.

const uint FAN = 0x80000000u;
const float WIDTH = 1.0;
const vec3 LINE = vec3(0.10), FILL = vec3(0.86);

in vec3 seen_at;
in vec3 facing;
in vec2 grid;
flat in uvec2 where;

layout(location = 0) out vec4 colour;

void main()
{
    vec2 nearest = round(grid);
    vec2 per_px = vec2(length(vec2(dFdxFine(grid.x), dFdyFine(grid.x))),
                       length(vec2(dFdxFine(grid.y), dFdyFine(grid.y))));
    vec2 px = abs(grid - nearest) / max(per_px, 1e-20);
    // Of a fan's part only the edges at the n-gon's corner are edges.
    bvec2 inner = bvec2((where.x & FAN) != 0u && nearest.x > 0.0, (where.x & FAN) != 0u && nearest.y > 0.0);
    px = mix(px, vec2(1e9), inner);
    float ink = clamp(0.5 + 0.5 * WIDTH - min(px.x, px.y), 0.0, 1.0);
    colour = vec4(mix(FILL, LINE, ink), 1.0);
}
