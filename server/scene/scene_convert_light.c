/* Converts line families, lights and patterns between messages and the renderer's structs. */
#include <string.h>

#include "protocol/messages/message_values.h"
#include "server/scene/scene_convert.h"
#include "server/scene/defaults.h"

#define SAME(a, b) ((int)(a) == (int)(b))
_Static_assert(SAME(PATTERN_IMAGE, sheen_PatternKind_PATTERN_IMAGE) &&
                   SAME(PATTERN_DISTANCE, sheen_PatternKind_PATTERN_DISTANCE) &&
                   SAME(LIGHT_SPHERE, sheen_LightKind_LIGHT_SPHERE) &&
                   SAME(LINES_ENVIRONMENT, sheen_LineFamily_LINES_ENVIRONMENT),
               "patterns, lights and families have the same numbers on the wire");
_Static_assert(SAME(MAX_LIGHTS, sizeof((sheen_Render *)0)->lights / sizeof(sheen_Light)) &&
                   SAME(MAX_LINES, sizeof((sheen_Pattern *)0)->at / sizeof(double)),
               "as many lights and lines as the wire carries");

static const sheen_Colour DEFAULT_FOREGROUND = {1, 1, 1, 1};
static const sheen_Colour DEFAULT_BACKGROUND = {0, 0, 0, 1};

static void to_pattern(const sheen_Pattern *from, struct pattern *to)
{
    *to = (struct pattern){
        .kind = (enum pattern_kind)from->kind,
        MESSAGE_PATTERN_NUMBERS_OF(from),
    };
    for (uint32_t i = 0; i < to->n_at; i++)
        to->at[i] = from->at[i];
    message_read_colour(from->has_foreground ? &from->foreground : &DEFAULT_FOREGROUND,
                        to->foreground);
    message_read_colour(from->has_background ? &from->background : &DEFAULT_BACKGROUND,
                        to->background);
}

static sheen_Pattern from_pattern(const struct pattern *pattern, const sheen_Pattern *asked)
{
    sheen_Pattern wire = {
        .kind = (sheen_PatternKind)pattern->kind,
        MESSAGE_PATTERN_NUMBERS(pattern),
        .at_count = (pb_size_t)pattern->n_at,
        .has_width = true,
        .has_foreground = true,
        .foreground = message_colour(pattern->foreground),
        .has_background = true,
        .background = message_colour(pattern->background),
    };
    for (uint32_t i = 0; i < pattern->n_at; i++)
        wire.at[i] = pattern->at[i];
    if (asked && asked->has_image_sha256) {
        wire.has_image_sha256 = true;
        memcpy(wire.image_sha256, asked->image_sha256, sizeof wire.image_sha256);
    }
    return wire;
}

/* The default light is one that every ray meets. */
static enum light_kind kind_of(const sheen_Light *light)
{
    return light->has_kind || light->has_centre ? (enum light_kind)light->kind : LIGHT_TUNNEL;
}

void scene_read_light(const sheen_Light *from, const struct scene_subject *subject,
                      const double up[3], struct light *to)
{
    static const sheen_Pattern default_pattern = sheen_Pattern_init_default;
    *to = (struct light){.kind = kind_of(from), .one_sided = from->one_sided};
    if (from->has_centre) {
        message_read_vec3(&from->centre, to->centre);
        message_read_vec3(&from->u, to->u);
        message_read_vec3(&from->v, to->v);
    } else {
        to->is_chosen = true;
        scene_default_light(subject->tables->box_min, subject->tables->box_max, up, to);
    }
    to_pattern(from->has_pattern ? &from->pattern : &default_pattern, &to->pattern);
}

sheen_Light scene_write_light(const struct light *light, const sheen_Light *asked)
{
    return (sheen_Light){
        .has_centre = true,
        .centre = message_vec3(light->centre),
        .has_u = true,
        .u = message_vec3(light->u),
        .has_v = true,
        .v = message_vec3(light->v),
        .has_kind = true,
        .kind = (sheen_LightKind)light->kind,
        .has_one_sided = true,
        .one_sided = light->one_sided,
        .has_pattern = true,
        .pattern = from_pattern(&light->pattern, asked ? &asked->pattern : NULL),
    };
}

void scene_read_lines(const sheen_Lines *from, const double up[3], struct lines *to)
{
    *to = (struct lines){.family = (enum line_family)from->family};
    bool needs_axis = to->family == LINES_ZEBRA || to->family == LINES_ENVIRONMENT;
    to->has_direction = from->has_direction || needs_axis;
    if (from->has_direction)
        message_read_vec3(&from->direction, to->direction);
    else if (needs_axis)
        memcpy(to->direction, up, sizeof to->direction);
    if (from->has_eye || from->has_eye_direction) {
        to->eye_kind = from->has_eye ? LINE_EYE_POINT : LINE_EYE_DIRECTION;
        message_read_vec3(from->has_eye ? &from->eye : &from->eye_direction, to->eye);
    }
}

sheen_Lines scene_write_lines(const struct lines *lines)
{
    return (sheen_Lines){
        .family = (sheen_LineFamily)lines->family,
        .has_direction = lines->has_direction,
        .direction = message_vec3(lines->direction),
        .has_eye = lines->eye_kind == LINE_EYE_POINT,
        .eye = message_vec3(lines->eye),
        .has_eye_direction = lines->eye_kind == LINE_EYE_DIRECTION,
        .eye_direction = message_vec3(lines->eye),
    };
}
