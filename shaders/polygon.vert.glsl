// Projects the polygons of server/render/mesh.h, for polygon.frag.glsl and wireframe.frag.glsl.

layout(location = 0) in vec3 position;  // relative to the mesh's centre, world axes
layout(location = 1) in vec3 normal;    // unit; zero where there is no normal
layout(location = 2) in uint face;      // Ptex face, plus the fan's bit
layout(location = 3) in uvec4 cell;     // x, y, cells along an edge

uniform vec3 centre;  // of the mesh, relative to the eye

out vec3 seen_at;   // relative to the eye, world axes
out vec3 facing;    // normals as a graphics card interpolates them: not unit
out vec2 grid;      // in cells
flat out uvec2 where;  // face, cells

invariant gl_Position;  // the wireframe is drawn over depths that the same vertices left

void main()
{
    seen_at = position + centre;
    facing = normal;
    grid = vec2(cell.xy);
    where = uvec2(face, cell.z);
    vec3 s = to_camera(seen_at);
    float w = is_perspective() ? s.z : 1.0;
    float z = is_perspective() ? depth.x : depth.y + s.z * depth.z;
    gl_Position = vec4(s.xy * clip.xy + w * clip.zw, z, w);
}
