// Encodes linear light in [0,1] by the sRGB curve (IEC 61966-2-1), as in pictures of 8 bits.
vec3 srgb_encoded(vec3 light)
{
    return mix(12.92 * light, 1.055 * pow(max(light, 0.0031308), vec3(1.0 / 2.4)) - 0.055,
               step(0.0031308, light));
}
