// What the lights show of a pixel or a part of it, and how that becomes the pixel's colour.
//
// Lights are shaded one after the other, the hindmost first. Two planes hold, as linear light, what the lights behind
// show; each light but the foremost writes the next two (the host alternates between two pairs, since the passes over
// edges read again what lies behind). The foremost light writes the colour.

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

// The smallest alpha that eight bits can hold; a colour with less becomes 0.
const float LEAST_ALPHA = 0.5 / 255.0;

void put_colour(ivec2 p, vec4 light)
{
    vec3 straight = light.a >= LEAST_ALPHA ? light.rgb / light.a : vec3(0.0);
    imageStore(colour, p, vec4(srgb_encoded(straight), light.a));
}

// Writes the pixel. `miss` shows where no light is met, `empty` where no surface is seen; `open` is the share without
// surface.
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
