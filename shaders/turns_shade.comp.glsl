// What a listed pixel without an edge shows, over which the normal turns so far that one footprint
// cannot tell: its own paraboloid in SIDE x SIDE squares, each shaded by itself.

layout(local_size_x = 64) in;

const int SIDE = 3;

void main()
{
    uint index = (gl_WorkGroupID.y * ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (index >= listed.n)
        return;
    ivec2 p = list_place(listed.at[index]);
    Piece piece = piece_of(hit_at(p), p, ivec2(0));
    Shown behind = shown_behind(p), sum = Shown(vec4(0.0), 0.0);
    float n = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        vec2 d = (vec2(i % SIDE, i / SIDE) + 0.5) / float(SIDE) - 0.5;
        float z = depth_at(piece, d);
        if (z < NOWHERE) {
            sum = added(sum, shade_ray(piece.hit, pixel_offset(p) + d, d, 1.0 / float(SIDE), z, behind));
            n += 1.0;
        }
    }
    if (n > 0.0)
        put_shown(p, scaled(sum, 1.0 / n), 0.0);
}
