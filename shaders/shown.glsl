// What the lights show of a pixel, or of a part of it, and how that becomes the pixel's colour.
//
// Lights are shaded one after the other, the hindmost first. What those behind show stands in two planes
// as linear light, and each light but the foremost writes the next such two (shade.c takes turns with
// them, since the passes over edges read again what lies behind). The foremost writes the colour.

layout(binding = 3, rgba8) writeonly uniform image2D colour;  // straight alpha, sRGB-encoded
layout(binding = 6, rgba16f) writeonly uniform image2D next_light;
layout(binding = 7, r16f) writeonly uniform image2D next_missed;
layout(binding = 1) uniform sampler2D behind_light;
layout(binding = 2) uniform sampler2D behind_missed;

struct Shown {
    vec4 light;    // linear, premultiplied by alpha
    float missed;  // share of the area where no light has been met yet
};

const Shown NOT_SHOWN = Shown(vec4(0.0), 1.0);

Shown scaled(Shown a, float share)
{
    return Shown(a.light * share, a.missed * share);
}

Shown added(Shown a, Shown b)
{
    return Shown(a.light + b.light, a.missed + b.missed);
}

// What the lights behind this one show.
Shown shown_behind(ivec2 p)
{
    if (is_hindmost)
        return NOT_SHOWN;
    return Shown(texelFetch(behind_light, p, 0), texelFetch(behind_missed, p, 0).x);
}

// The least alpha that eight bits hold: a colour of less has no digits and is 0.
const float LEAST_ALPHA = 0.5 / 255.0;

void put_colour(ivec2 p, vec4 light)
{
    vec3 straight = light.a >= LEAST_ALPHA ? light.rgb / light.a : vec3(0.0);
    imageStore(colour, p, vec4(srgb_encoded(straight), light.a));
}

// Where no light is met `miss` shows, where no surface is seen `empty`: `open` is the latter's share.
void put_shown(ivec2 p, Shown shown, float open)
{
    if (is_foremost) {
        put_colour(p, shown.light + shown.missed * miss + open * empty);
        return;
    }
    shown = scaled(shown, 1.0 / max(1.0 - open, 1e-6));
    imageStore(next_light, p, shown.light);
    imageStore(next_missed, p, vec4(shown.missed));
}
