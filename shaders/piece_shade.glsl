// Shades a piece of surface (pieces.glsl) at a place other than the hit it was made from.

// The offset from a hit to depth z on the ray of q; that ray is d px from the hit's own.
vec3 move_to(Hit hit, vec2 d, vec2 q, float z)
{
    vec3 across = (axis[0].xyz * d.x + axis[1].xyz * d.y) * pixel_units(hit.depth);
    return across + to_world(vec3(q * ray.x, 1.0)) * (z - hit.depth);
}

// d: offset from the hit's own pixel, px; size: side of the square to shade, px.
Shown shade_ray(Hit hit, vec2 q, vec2 d, float size, float z, Shown behind)
{
    vec3 move = move_to(hit, d, q, z);
    Sample at = sample_at(q, size, z, normal_at(hit, move), hit.h, hit.n);
    return lay_over(behind, at, meet(at), q);
}
