// Polygons in place of the surface (--surface polygon:LEVEL): the curvature that their interpolated normals imply.

// A bit of mesh_vertex.face (server/render/mesh.h): only the edges at the n-gon's corner are edges of the mesh.
const uint FAN = 0x80000000u;

// The shape operator that turns the interpolated normal n = N / size from pixel to pixel as interpolation does: h .
// dx = -dn for both pixel steps, dx being the step in the plane perpendicular to n that stage 3 takes. N changes by
// change_x with a pixel to the right and by change_y with a pixel down. n is the normal of no surface, so h need not
// be symmetric; its symmetric part is returned.
vec3 polygon_shape(vec3 n, float size, float z, vec2 q, vec3 change_x, vec3 change_y)
{
    vec3 e1, e2;
    tangent_basis(n, e1, e2);
    vec3 d = to_world(vec3(q * ray.x, 1.0));
    vec3 right = axis[0].xyz * pixel_units(z), down = axis[1].xyz * pixel_units(z);
    right -= d * (dot(right, n) / dot(d, n));
    down -= d * (dot(down, n) / dot(d, n));
    mat2 steps = mat2(dot(right, e1), dot(right, e2), dot(down, e1), dot(down, e2));
    mat2 turns = mat2(-vec2(dot(change_x, e1), dot(change_x, e2)) / size,
                      -vec2(dot(change_y, e1), dot(change_y, e2)) / size);
    float area = steps[0].x * steps[1].y - steps[1].x * steps[0].y;
    mat2 h = turns * mat2(steps[1].y, -steps[0].y, -steps[1].x, steps[0].x);
    bool is_known = abs(dot(d, n)) > 0.0 && abs(area) > 0.0;
    return is_known ? vec3(h[0].x, 0.5 * (h[0].y + h[1].x), h[1].y) / area : vec3(0.0);
}
