// Reads what stage 2 wrote for each pixel (planes.glsl), for stage 3 and the passes for edges.

layout(binding = 0, r32f) readonly uniform image2D hit_depth;
layout(binding = 1, rgba32f) readonly uniform image2D normal;
layout(binding = 2, rg32f) readonly uniform image2D shape;

struct Hit {
    vec3 x;      // relative to the eye, world axes
    float depth; // 0: nothing
    vec3 n;      // unit; zero where there is none
    vec3 h;      // shape operator in tangent_basis(n): (1,1), (1,2), (2,2)
};

// Outside the tile the depth is -1: unknown.
Hit hit_at(ivec2 p)
{
    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, tile.zw)))
        return Hit(vec3(0.0), -1.0, vec3(0.0), vec3(0.0));
    float z = imageLoad(hit_depth, p).x;
    vec4 facing = imageLoad(normal, p);
    return Hit(on_ray(pixel_offset(p), z), z, facing.xyz, vec3(imageLoad(shape, p).xy, facing.w));
}

// Whether the surface reflects here: a place without a normal does not.
bool mirrors(Hit hit)
{
    return hit.depth > 0.0 && dot(hit.n, hit.n) > 0.5;
}
