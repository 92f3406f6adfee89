#include "client/cli/output/scene_json.h"

#include <math.h>
#include <stdio.h>

#include "client/cli/options/lights_text.h"
#include "client/cli/options/values.h"

/* Writes a colour in the form of the options. */
static void json_colour(struct json *json, const char *key, const float colour[4])
{
    char text[10];
    unsigned byte[4];
    for (int k = 0; k < 4; k++)
        byte[k] = (unsigned)lroundf(255 * colour[k]);
    snprintf(text, sizeof(text), "#%02x%02x%02x%02x", byte[0], byte[1], byte[2], byte[3]);
    json_text(json, key, text);
}

static void json_camera(struct json *json, const struct sheen_camera *camera)
{
    json_object_begin(json, "camera");
    json_vec3(json, "eye", camera->eye);
    json_vec3(json, "target", camera->target);
    json_vec3(json, "up", camera->up);
    if (camera->projection == SHEEN_PROJECTION_ORTHOGRAPHIC)
        json_double(json, "ortho_height", camera->ortho_height);
    else
        json_double(json, "fov_deg", camera->fov_deg);
    json_object_end(json);
}

/* Writes the model's up direction and where it comes from. */
static void json_up(struct json *json, const struct sheen_frame *frame)
{
    static const char *const sources[] = {"given", "file", "guessed"};
    if (frame->up_source == SHEEN_UP_UNKNOWN)
        return;
    json_vec3(json, "up", frame->up);
    json_text(json, "up_source", sources[frame->up_source]);
}

/* Writes the zoom, which has changed eye, target and field of view. */
static void json_zoom(struct json *json, const struct sheen_camera *camera)
{
    json_object_begin(json, "zoom");
    json_double(json, "factor", camera->zoom);
    json_array_begin(json, "at");
    for (int i = 0; i < 2; i++)
        json_double(json, NULL, camera->zoom_at[i]);
    json_array_end(json);
    json_object_end(json);
}

static void json_family(struct json *json, const struct sheen_lines *lines)
{
    static const char *const eyes[] = {"camera", "point", "direction"};
    json_text(json, "lines", text_line_family(lines->family));
    if (lines->has_direction)
        json_vec3(json, "lines_direction", lines->direction);
    json_object_begin(json, "line_eye");
    json_text(json, "kind", eyes[lines->eye_kind]);
    if (lines->eye_kind != SHEEN_LINE_EYE_CAMERA)
        json_vec3(json, eyes[lines->eye_kind], lines->eye);
    json_object_end(json);
}

static void json_pattern(struct json *json, const struct sheen_pattern *pattern)
{
    json_object_begin(json, "pattern");
    json_text(json, "kind", text_pattern_kind(pattern->kind));
    json_double(json, "count", pattern->count);
    if (pattern->period > 0)
        json_double(json, "period", pattern->period);
    json_double(json, "duty", pattern->duty);
    json_double(json, "rotation_deg", pattern->rotation_deg);
    json_double(json, "offset", pattern->offset);
    json_double(json, "soft", pattern->soft);
    json_double(json, "opacity", pattern->opacity);
    if (pattern->kind == SHEEN_PATTERN_LINES) {
        json_array_begin(json, "at");
        for (uint32_t i = 0; i < pattern->n_at; i++)
            json_double(json, NULL, pattern->at[i]);
        json_array_end(json);
        json_double(json, "width", pattern->width);
    }
    if (pattern->kind == SHEEN_PATTERN_IMAGE)
        json_hex(json, "image_sha256", pattern->image_id, SHEEN_ID_BYTES);
    json_colour(json, "fg", pattern->foreground);
    json_colour(json, "bg", pattern->background);
    json_object_end(json);
}

static void json_light(struct json *json, const char *name, const struct sheen_light *light)
{
    json_object_begin(json, name);
    json_text(json, "kind", text_light_kind(light->kind));
    json_bool(json, "one_sided", light->one_sided);
    json_vec3(json, "center", light->centre);
    json_vec3(json, "u", light->u);
    json_vec3(json, "v", light->v);
    json_pattern(json, &light->pattern);
    json_object_end(json);
}

static void json_lights(struct json *json, const struct sheen_light *lights, uint32_t n)
{
    json_light(json, "light", &lights[0]);
    json_array_begin(json, "lights");
    for (uint32_t i = 0; i < n; i++)
        json_light(json, NULL, &lights[i]);
    json_array_end(json);
}

void scene_json_lines(struct json *json, const struct sheen_camera *camera,
                      const struct sheen_lines *lines, const struct sheen_light *lights, uint32_t n)
{
    json_camera(json, camera);
    json_family(json, lines);
    json_lights(json, lights, n);
}

static void json_extreme(struct json *json, const char *key, const struct sheen_extreme *extreme)
{
    const double null = (double)NAN; /* written as null */
    if (!extreme->has_value) {
        json_double(json, key, null);
        return;
    }
    json_object_begin(json, key);
    json_double(json, "value", extreme->value);
    if (extreme->has_place) {
        json_array_begin(json, "pixel");
        json_uint(json, NULL, extreme->x_px);
        json_uint(json, NULL, extreme->y_px);
        json_array_end(json);
        json_vec3(json, "position", extreme->position);
    } else {
        json_double(json, "pixel", null);
        json_double(json, "position", null);
    }
    if (extreme->has_ptex) {
        json_object_begin(json, "ptex");
        json_uint(json, "face", extreme->face);
        json_double(json, "u", extreme->u);
        json_double(json, "v", extreme->v);
        json_object_end(json);
    }
    json_object_end(json);
}

static void json_show(struct json *json, const struct sheen_show *show,
                      const struct sheen_frame *frame)
{
    json_text(json, "show", text_show_kind(show->kind));
    if (show->kind == SHEEN_SHOW_DRAFT)
        json_vec3(json, "show_direction", show->direction);
    if (show->kind != SHEEN_SHOW_LINES)
        json_text(json, "legend", show->without_legend ? "off" : "on");
    if (frame->show_range > 0) {
        json_double(json, "show_range", frame->show_range);
        json_extreme(json, "show_least", &frame->show_least);
        json_extreme(json, "show_greatest", &frame->show_greatest);
    }
}

static void json_planes(struct json *json, uint32_t planes)
{
    json_array_begin(json, "aov");
    for (uint32_t plane = SHEEN_PLANE_COLOUR << 1; plane < 1u << SHEEN_N_PLANES; plane <<= 1)
        if (planes & plane)
            json_text(json, NULL, value_plane_name(plane));
    json_array_end(json);
}

void scene_json(struct json *json, const struct sheen_request *request,
                const struct sheen_frame *frame)
{
    static const char *const surfaces[] = {"exact", "polygon", "wireframe"};
    json_camera(json, &frame->camera);
    json_up(json, frame);
    if (value_view_name(request->camera.view))
        json_text(json, "view", value_view_name(request->camera.view));
    if (request->camera.zoom > 0)
        json_zoom(json, &request->camera);
    json_family(json, &frame->lines);
    json_lights(json, frame->lights, frame->n_lights);
    json_double(json, "light_share", frame->light_share);
    if (frame->has_colours) {
        json_colour(json, "miss", frame->miss);
        json_colour(json, "empty", frame->empty);
        json_colour(json, "base", frame->base);
    }
    json_text(json, "antialias", request->aliased || request->unfiltered ? "off" : "exact");
    json_text(json, "filter", request->unfiltered ? "off" : "exact");
    json_text(json, "surface", surfaces[request->surface]);
    if (request->surface != SHEEN_SURFACE_EXACT)
        json_uint(json, "surface_level", request->surface_level);
    json_show(json, &request->show, frame);
    json_planes(json, frame->planes);
}
