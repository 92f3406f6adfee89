// The camera, shared by every stage.
//
// Camera space: x right, y down (as pixel rows go), z forward from the eye; world units.
// The ray of pixel (x,y) is  o + z d,  o = q * ray.y,  d = (q * ray.x, 1),  q = (x,y) + 1/2 - centre,
// so perspective has ray = (1 / focal length in px, 0) and orthographic (0, units per px).
// One pixel at depth z is  z ray.x + ray.y  units wide.

layout(std140, binding = 0) uniform View {
    dvec4 eye;          // world
    vec4 axis[3];       // right, down, forward, world
    vec4 ray;           // ray.x, ray.y as above; principal point (px) in zw
    vec4 clip;          // x,y: clip units per (unit * w); z,w: clip offset per w
    vec4 depth;         // perspective: near in x; orthographic: ndc depth = depth.y + z * depth.z
    ivec4 tile;         // x0, y0, width, height of the part of the picture being drawn (px)
};

bool is_perspective()
{
    return ray.x > 0.0;
}

float pixel_units(float z)
{
    return z * ray.x + ray.y;
}

vec2 pixel_offset(ivec2 pixel)  // q of a pixel of the tile
{
    return vec2(pixel + tile.xy) + 0.5 - ray.zw;
}

vec3 to_camera(vec3 world_direction)
{
    return vec3(dot(axis[0].xyz, world_direction), dot(axis[1].xyz, world_direction),
                dot(axis[2].xyz, world_direction));
}

vec3 to_world(vec3 camera_direction)
{
    return axis[0].xyz * camera_direction.x + axis[1].xyz * camera_direction.y +
           axis[2].xyz * camera_direction.z;
}

// The point at depth z on the ray of q, relative to the eye, world axes.
vec3 on_ray(vec2 q, float z)
{
    return to_world(vec3(q * pixel_units(z), z));
}
