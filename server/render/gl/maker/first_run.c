#include "server/render/gl/maker/first_run.h"

#include "server/render/gl/context/quirks.h"
#include "server/render/gl/light_image.h"
#include "server/render/gl/shade.h"

/* Neither side of such a target is a power of two, as with targets of frames. */
enum { SMALLEST_SIDE = 3 };

/* A small image of each kind that image_quirks() distinguishes. */
static GLuint make_picture(uint8_t quirks)
{
    static float texels[4 * SMALLEST_SIDE * SMALLEST_SIDE];
    uint32_t side[2] = {quirks & 2 ? 2 : SMALLEST_SIDE, quirks & 4 ? 2 : SMALLEST_SIDE};
    if (quirks & 8)
        side[0] = side[1] = 1;
    const struct image image = {
        .width_px = side[0], .height_px = side[1], .is_float = quirks & 1, .pixels = texels};
    return light_texture_create(&image);
}

static void bind_picture(struct first_runs *runs, const struct shade_key *key)
{
    const struct frame_request request = {.lines.family = (enum line_family)key->family};
    const struct light light = {.kind = (enum light_kind)key->light};
    if (key->pattern != PATTERN_IMAGE || key->picture >= N_PICTURE_KINDS) {
        glBindTextureUnit(0, runs->blank);
        return;
    }
    GLuint *picture = &runs->picture[key->picture];
    if (!*picture)
        *picture = make_picture(key->picture);
    shade_bind_picture(*picture, &request, &light);
}

void first_run(struct first_runs *runs, const struct shade_key *key, GLuint program)
{
    struct target *target = &runs->target[key->has_several != 0];
    struct error error;
    if (!target_reserve(target, SMALLEST_SIDE, SMALLEST_SIDE, &error) ||
        (key->has_several && !target_reserve_lights(target, &error)))
        return; /* the program's first run is on the render thread then */
    if (!runs->no_groups) {
        runs->no_groups = shade_no_groups();
        runs->blank = shade_blank_texture();
    }
    bind_picture(runs, key);
    shade_run_over_nothing(target, runs->no_groups, (enum shaded)key->which, program);
}
