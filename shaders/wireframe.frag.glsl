// Draws the edges of the polygons over the shaded picture.

in vec3 seen_at;
in vec3 facing;
in vec2 grid;
flat in uvec2 where;

layout(location = 0) out vec4 colour;

void main()
{
    colour = wireframe_colour(grid, dFdxFine(grid), dFdyFine(grid), (where.x & FAN) != 0u);
}
