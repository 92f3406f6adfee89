// The planes that stage 2 writes for each pixel that is hit, for stage 3 and for the caller. Stage 1 clears hit_depth
// and ptex. The including program defines PTEX if the caller asked for that plane.

// Depth along the view axis; 0 where nothing is hit.
layout(binding = 0, r32f) writeonly uniform image2D hit_depth;
// Unit normal, oriented by the winding; w: shape operator entry (2,2).
layout(binding = 1, rgba32f) writeonly uniform image2D normal;
// Shape operator entries (1,1) and (1,2) in the basis tangent_basis(normal), 1/unit.
layout(binding = 2, rg32f) writeonly uniform image2D shape;
#ifdef PTEX
layout(binding = 3, rgba32ui) writeonly uniform uimage2D ptex;
#endif
// border.glsl
layout(binding = 4, r32ui) writeonly uniform uimage2D border;

// The shape operator, second fundamental form over first, in the basis of basis.glsl: a and b are the steps in the
// surface's parameters that move one unit along e1 and e2.
vec3 shape_operator(Surface s, vec3 n_world)
{
    if (!(s.area2 > 0.0))
        return vec3(0.0);
    vec3 e1, e2;
    tangent_basis(n_world, e1, e2);
    e1 = to_camera(e1);
    e2 = to_camera(e2);
    vec2 a = vec2(dot(s.to_u, e1), dot(s.to_v, e1)), b = vec2(dot(s.to_u, e2), dot(s.to_v, e2));
    mat2 second = mat2(s.bend.xy, s.bend.yz);
    return vec3(dot(a, second * a), dot(a, second * b), dot(b, second * b)) / s.scale;
}

const float HALF_PIXEL = 0.71;  // from its centre to its corners

// The vector from the pixel's centre to the nearest border of the Ptex face, px: to the foot of the perpendicular on
// the border's line in the picture, exact to first order. A crease counts as a border if its rounding is narrower
// than THIN px; inside the rounding the vector is 0. ROUNDED if the pixel reaches into a rounding up to WIDE px wide.
uint border_of(Node node, vec2 xy, ivec2 steps, Surface s)
{
    // How the place in the picture changes with x and y, px.
    vec2 slope = is_perspective() ? s.s.xy / s.s.z : vec2(0.0);
    float px = s.scale / pixel_units(s.s.z);
    vec2 along_x = ldexp((s.su.xy - slope * s.su.z) * px, ivec2(steps.x));
    vec2 along_y = ldexp((s.sv.xy - slope * s.sv.z) * px, ivec2(steps.y));
    float area = along_x.x * along_y.y - along_x.y * along_y.x;
    // The step that raises x by one, perpendicular to the lines of equal x; the same for y.
    vec2 to_x = vec2(along_y.y, -along_y.x) * (area / max(dot(along_y, along_y), 1e-30));
    vec2 to_y = vec2(-along_x.y, along_x.x) * (area / max(dot(along_x, along_x), 1e-30));
    // Number of cells between the node's edges and the face's.
    vec2 last = vec2((1u << node.depth) - 1u), cell = vec2(node.cell);
    vec4 cells = vec4(cell.y, last.x - cell.x, last.y - cell.y, cell.x);
    uint k = node.rotation;
    cells = k == 0u ? cells : k == 1u ? cells.yzwx : k == 2u ? cells.zwxy : cells.wxyz;
    vec4 away = cells + vec4(xy.y, 1.0 - xy.x, 1.0 - xy.y, xy.x);
    vec2 nearest = NO_BORDER;
    float width = 0.0;
    bool is_rounded = false;
    for (int e = 0; e < 4; e++) {
        uint border = node.borders >> 4 * e & 15u;
        vec2 to = e == 0 ? -to_y : e == 1 ? to_x : e == 2 ? to_y : -to_x;
        float rounding = border == BORDER_SHARP ? 0.0 : ldexp(1.0, int(node.depth) - int(border));
        float rounding_px = rounding * length(to);
        float beyond_px = (away[e] - rounding) * length(to);
        is_rounded = is_rounded || (border != 0u && rounding_px >= THIN && rounding_px < WIDE &&
                                    beyond_px < HALF_PIXEL);
        vec2 foot = (away[e] < rounding ? 0.0 : away[e]) * to;
        if (border != 0u && rounding_px < THIN && dot(foot, foot) < dot(nearest, nearest)) {
            nearest = foot;
            width = rounding_px;
        }
    }
    return is_rounded ? ROUNDED : pack_border(nearest, width);
}

// steps: the surface's parameters grow 2^steps times as fast as the node's x,y.
void store_hit(ivec2 p, Node node, vec2 xy, ivec2 steps, Surface s)
{
    vec3 n = dot(s.n, s.n) > 0.0 ? normalize(to_world(s.n)) : vec3(0.0);
    vec3 h = shape_operator(s, n);
    imageStore(hit_depth, p, vec4(s.s.z));
    imageStore(normal, p, vec4(n, h.z));
    imageStore(shape, p, vec4(h.xy, 0.0, 0.0));
    imageStore(border, p, uvec4(border_of(node, xy, steps, s)));
#ifdef PTEX
    imageStore(ptex, p, uvec4(node.face, floatBitsToUint(ptex_uv(node, xy)), 0u));
#endif
}
