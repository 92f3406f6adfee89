// Writes which place of the surface is seen: node, level, and the rasterised parameters. Those belong to the
// triangle, not to the pixel's ray: stage 2 uses them only as a first guess, so 13 bits are enough.

flat in uvec2 where;
in vec2 st;
layout(location = 0) out uvec2 seen;

void main()
{
    uvec2 q = uvec2(clamp(st * 0.5, 0.0, 1.0) * 8191.0 + 0.5);
    seen = uvec2(where.x, where.y | q.x << 6 | q.y << 19);
}
